"""Models of arms, as text."""

TREE = """<mujoco><option gravity="0.3 -0.2 -9.81"/><worldbody>
<body name="column" pos="0.1 0 0.2" quat="0.9 0.1 0.2 0.1">
 <joint name="turn" axis="0 0.3 1" pos="0.02 0.01 0" damping="0.5" frictionloss="0.2"
  armature="0.01"/>
 <geom type="box" size="0.05 0.1 0.2" pos="0.03 0.02 0.1" mass="2"/>
 <body name="carriage" pos="0 0.1 0.3">
  <joint name="slide" type="slide" axis="1 0.2 0"/>
  <joint name="swing" axis="0 1 0.1" pos="0 0 0.05"/>
  <geom type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.03" mass="1.5"/>
  <body name="hand" pos="0.3 0 0" euler="10 20 30">
   <joint name="wrist" axis="0 1 0" ref="0.2"/>
   <geom type="box" size="0.02 0.05 0.1" pos="0.1 0.05 0" mass="0.8"/></body>
  <body name="counterweight" pos="-0.2 0 0">
   <joint name="branch" axis="1 0 0"/>
   <geom type="sphere" size="0.05" pos="0 0.1 0" mass="0.6"/></body>
 </body></body></worldbody></mujoco>"""


def written(folder, name, text):
    (folder / name).write_text(text)
    return folder
