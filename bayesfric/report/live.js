// Charts in the place of still figures: pointed at, zoomed, and filtered by kind.
// Without scripts, and on paper, the still figures stay.
(() => {
  "use strict";
  const { Plotting, ColumnDataSource, HoverTool, FixedTicker, Range1d } = Bokeh;
  const touched = window.matchMedia("(pointer: coarse)").matches;
  const numbers = values => Float64Array.from(values, value => (value === null ? NaN : value));

  const figureOf = chart => {
    const rows = chart.rows.length;
    const fig = Plotting.figure({
      title: chart.title,
      x_axis_label: chart.x_label,
      y_axis_label: chart.y_label,
      height: rows ? 90 + 24 * rows : 340,
      sizing_mode: "stretch_width",
      tools: "pan,box_zoom,wheel_zoom,reset,save",
      // A finger that drags scrolls the page.
      active_drag: touched ? null : "box_zoom",
      ...(rows ? { y_range: new Range1d({ start: rows - 0.4, end: -0.6 }) } : {}),
    });
    if (rows) {
      fig.left[0].ticker = new FixedTicker({ ticks: chart.rows.map((_, row) => row) });
      fig.left[0].major_label_overrides = new Map(chart.rows.map((name, row) => [row, name]));
    }
    fig.toolbar.logo = null;
    return fig;
  };

  const points = (fig, chart, cloud) => {
    const data = { x: numbers(cloud.x), y: numbers(cloud.y) };
    cloud.said.forEach((words, column) => { data[`said${column}`] = words; });
    const shown = [];
    if (cloud.low !== null) {
      data.low = numbers(cloud.low);
      data.high = numbers(cloud.high);
    }
    const source = new ColumnDataSource({ data });
    const across = chart.rows.length > 0; // a bar a row, which is easier to point at than its dot
    if (cloud.low !== null) {
      const ends = across
        ? { x0: { field: "low" }, x1: { field: "high" }, y0: { field: "y" }, y1: { field: "y" } }
        : { x0: { field: "x" }, x1: { field: "x" }, y0: { field: "low" }, y1: { field: "high" } };
      const look = { line_color: cloud.color, line_width: across ? 4 : 1.5, line_alpha: 0.6 };
      shown.push(fig.segment({ ...ends, ...look, source }));
    }
    const many = cloud.x.length > 1000;
    const dots = fig.scatter({
      x: { field: "x" }, y: { field: "y" }, source, marker: cloud.marker,
      size: many ? 3 : 7, line_color: cloud.color, fill_color: cloud.color,
      fill_alpha: many ? 0.4 : 0.25, line_alpha: many ? 0.4 : 1,
    });
    const bars = across && shown.length > 0 ? shown[0] : dots;
    shown.push(dots);
    return { shown, pointed: bars };
  };

  const draw = (chart, place, filters) => {
    const fig = figureOf(chart);
    const kinds = new Map();
    const keep = (name, drawn) => kinds.set(name, [...(kinds.get(name) ?? []), ...drawn]);
    for (const band of chart.bands) {
      const source = new ColumnDataSource({
        data: { x: numbers(band.x), y1: numbers(band.low), y2: numbers(band.high) },
      });
      keep(band.name, [fig.varea({
        x: { field: "x" }, y1: { field: "y1" }, y2: { field: "y2" }, source,
        fill_color: band.color, fill_alpha: 0.2,
      })]);
    }
    for (const curve of chart.curves) {
      const source = new ColumnDataSource({ data: { x: numbers(curve.x), y: numbers(curve.y) } });
      keep(curve.name, [fig.line({
        x: { field: "x" }, y: { field: "y" }, source,
        line_color: curve.color, line_dash: curve.dashed ? "dashed" : "solid",
      })]);
    }
    const pointed = [];
    for (const cloud of chart.clouds) {
      const drawn = points(fig, chart, cloud);
      keep(cloud.name, drawn.shown);
      pointed.push(drawn.pointed);
    }
    const tooltips = chart.columns.map((name, column) => [name, `@said${column}`]);
    fig.add_tools(new HoverTool({ renderers: pointed, tooltips }));
    for (const [name, box] of filters) {
      const follow = () => {
        for (const drawn of kinds.get(name) ?? []) drawn.visible = box.checked;
      };
      box.addEventListener("change", follow);
      follow();
    }
    Plotting.show(fig, place);
  };

  const filtersOf = (charts, place) => {
    const colors = new Map(charts.flatMap(c => c.clouds.map(cloud => [cloud.name, cloud.color])));
    if (colors.size < 2) return new Map();
    const set = document.createElement("fieldset");
    const legend = document.createElement("legend");
    legend.textContent = "Show";
    set.append(legend);
    const boxes = new Map();
    for (const [name, color] of colors) {
      const label = document.createElement("label");
      const box = document.createElement("input");
      box.type = "checkbox";
      box.checked = true;
      box.style.accentColor = color;
      label.append(box, ` ${name}`);
      set.append(label);
      boxes.set(name, box);
    }
    place.append(set);
    return boxes;
  };

  const begin = (held, image) => {
    const charts = JSON.parse(held.textContent);
    const live = document.createElement("div");
    live.className = "live";
    live.setAttribute("role", "group");
    live.setAttribute("aria-label", image.alt);
    const filters = filtersOf(charts, live);
    if (held.classList.contains("beside")) {
      image.after(live);
    } else {
      image.before(live);
      image.classList.add("still");
    }
    for (const chart of charts) {
      const place = document.createElement("div");
      live.append(place);
      draw(chart, place, filters);
    }
  };

  // What nobody has scrolled to yet is not drawn.
  const seen = new IntersectionObserver(entries => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      seen.unobserve(target);
      begin(target.querySelector("script.charts"), target.querySelector("img"));
    }
  }, { rootMargin: "600px" });
  for (const held of document.querySelectorAll("figure > script.charts")) {
    seen.observe(held.parentElement);
  }
})();
