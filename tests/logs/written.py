"""One motion of two joints, written as every kind of log, with the mapping of each."""

import json

import numpy as np

RATE_HZ = 64  # times, positions and forces are exact in 32 bits and in decimals alike
JOINTS = ("shoulder", "elbow")
BEGAN_NS = 1_780_000_000 * 10**9
RUNS = '[[runs]]\nname = "swing"\npayload_kg = 0.5\n'
ENDS = ("csv", "json", "jsonl", "npz", "mat", "v73.mat", "parquet", "mcap", "bag")


def motion(rows=300):
    """Times, and of each joint the positions [rad] and torques [N·m]."""
    time = np.arange(rows) / RATE_HZ
    position = np.stack([np.sin(2 * time), np.cos(3 * time)], axis=1)
    torque = np.stack([np.cos(5 * time), np.sin(time) - 0.5], axis=1)
    return time, np.round(position * 1024) / 1024, np.round(torque * 64) / 64


def mapping_of(position, force, time, more=""):
    """A mapping with these columns."""
    return (
        f"[time]\n{time}\n"
        f'[position]\ncolumn = {position}\nunit = "rad"\n'
        f'[force]\ncolumn = {force}\nunit = "N·m"\nforce_is = "motor"\n{more}{RUNS}'
    )


SECONDS = 'column = "t"'
NAMED = mapping_of('"q_{joint}"', '"tau_{joint}"', SECONDS)
MAPPINGS = {
    "csv": mapping_of(2, 4, f"rate_hz = {RATE_HZ}", "[csv]\nheader = false\n"),
    "json": NAMED,
    "jsonl": mapping_of('"state[1]"', '"effort[1]"', SECONDS),
    "npz": mapping_of('"q[1]"', '"tau[1]"', SECONDS),
    "mat": mapping_of('"log.q[1]"', '"log.tau[1]"', 'column = "log.t"'),
    "v73.mat": mapping_of('"log.q[1]"', '"log.tau[1]"', 'column = "log.t"'),
    "parquet": mapping_of(
        '"observation.state[{joint}]"', '"observation.effort[{joint}]"', 'column = "timestamp"'
    ),
    "mcap": mapping_of(
        '"/joint_states.position[{joint}]"',
        '"/joint_states.effort[{joint}]"',
        'column = "/joint_states.stamp"\nunit = "ns"',
    ),
}
MAPPINGS["bag"] = MAPPINGS["mcap"]


def write(folder, end, rows=300):
    """Write the motion, and return the path of the log."""
    return WRITERS[end](folder, *motion(rows))


def _csv(folder, time, position, torque):
    table = np.concatenate([position, torque], axis=1)
    path = folder / "log.csv"
    path.write_text("".join(",".join(map(repr, row)) + "\n" for row in table.tolist()), "utf-8")
    return path


def _json(folder, time, position, torque):
    columns = {"t": time.tolist()}
    for place, joint in enumerate(JOINTS):
        columns[f"q_{joint}"] = position[:, place].tolist()
        columns[f"tau_{joint}"] = torque[:, place].tolist()
    path = folder / "log.json"
    path.write_text(json.dumps(columns), "utf-8")
    return path


def _jsonl(folder, time, position, torque):
    rows = zip(time.tolist(), position.tolist(), torque.tolist(), strict=True)
    lines = [json.dumps({"t": at, "state": state, "effort": effort}) for at, state, effort in rows]
    path = folder / "log.jsonl"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


def _npz(folder, time, position, torque):
    path = folder / "log.npz"
    np.savez_compressed(path, t=time, q=position.astype(np.float32), tau=torque)
    return path


def _mat(folder, time, position, torque):
    from scipy.io import savemat

    path = folder / "log.mat"
    log = {"t": time[:, None], "q": position, "tau": torque, "note": "made up"}
    savemat(path, {"log": log}, do_compression=True)
    return path


def _mat_73(folder, time, position, torque):
    import h5py

    path = folder / "log.v73.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        group = file.create_group("log")
        group.create_dataset("t", data=time[None, :], compression="gzip")
        group.create_dataset("q", data=position.T, compression="gzip")
        group.create_dataset("tau", data=torque.T)
    head = b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM"
    with path.open("r+b") as stream:
        stream.write(head)
    return path


def _parquet(folder, time, position, torque):
    import pyarrow as pa
    import pyarrow.parquet as pq

    of_two = pa.list_(pa.float32(), 2)
    table = pa.table(
        {
            "action": pa.array(position.tolist(), of_two),
            "observation.state": pa.array(position.tolist(), of_two),
            "observation.effort": pa.array(torque.tolist(), of_two),
            "timestamp": pa.array(time, pa.float32()),
            "episode_index": pa.array(np.zeros(time.size), pa.int64()),
        }
    )
    names = {"motors": [f"{joint}.pos" for joint in JOINTS]}
    features = {f"observation.{key}": {"names": names} for key in ("state", "effort")}
    (folder / "data" / "chunk-000").mkdir(parents=True)
    (folder / "meta").mkdir()
    (folder / "meta" / "info.json").write_text(json.dumps({"features": features}), "utf-8")
    path = folder / "data" / "chunk-000" / "episode_000000.parquet"
    pq.write_table(table, path)
    return path


def _bag(folder, time, position, torque, storage="SQLITE3"):
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    state, header, stamp = (
        store.types[name]
        for name in (
            "sensor_msgs/msg/JointState",
            "std_msgs/msg/Header",
            "builtin_interfaces/msg/Time",
        )
    )
    with Writer(
        folder / "bag", version=9, storage_plugin=getattr(StoragePlugin, storage)
    ) as writer:
        link = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
        for at, positions, torques in zip(time, position, torque, strict=True):
            when = BEGAN_NS + round(at * 10**9)
            message = state(
                header(stamp(*divmod(when, 10**9)), ""),
                list(JOINTS),
                positions,
                np.zeros(2),
                torques,
            )
            writer.write(link, when + 1000, store.serialize_cdr(message, state.__msgtype__))
    return folder / "bag"


def _mcap(folder, time, position, torque):
    bag = _bag(folder, time, position, torque, "MCAP")
    return next(bag.glob("*.mcap"))


WRITERS = {
    "csv": _csv,
    "json": _json,
    "jsonl": _jsonl,
    "npz": _npz,
    "mat": _mat,
    "v73.mat": _mat_73,
    "parquet": _parquet,
    "mcap": _mcap,
    "bag": _bag,
}
