"""A mechanism with strings over round objects, written twice: as an OpenSim model and for MuJoCo.

Both describe the same thing in their own words: a torso on three axes, one after the other, an arm on a pin with a rod
that slides in it, a leg on another pin; oblique joint frames, mass centres off the joints, full inertia tensors;
strings from bone to bone, two of them over a sphere or a cylinder on the way."""

import dataclasses

import mujoco
import numpy

GRAVITY = "0.3 -9.7 0.4"


@dataclasses.dataclass(frozen=True)
class Body:
    name: str
    parent: str  # "ground" or a body
    position: str  # of the joint in the parent [m]
    angles: str  # of the joint's frame: turns about x, y and z, each about the turned axis [rad]
    joints: tuple  # (coordinate, "hinge" or "slide", axis in the joint's frame)
    mass: float
    mass_center: str
    inertia: str  # xx yy zz xy xz yz about the mass centre


BODIES = (
    Body(
        "torso", "ground", "0.1 1.0 -0.2", "0.2 -0.1 0.3",
        (("tilt", "hinge", "1 0 0"), ("list", "hinge", "0 1 0"), ("turn", "hinge", "0 0 1")),
        20.0, "0.02 0.1 0.03", "0.9 0.4 1.0 0.05 -0.08 0.03",
    ),
    Body(
        "arm", "torso", "0.0 0.3 0.2", "0.4 0.2 -0.3", (("elbow", "hinge", "0 0 1"),),
        2.0, "0.01 -0.15 0.02", "0.03 0.01 0.028 0.002 0.001 -0.003",
    ),
    Body(
        "rod", "arm", "0.02 -0.3 0.0", "-0.2 0.5 0.1", (("reach", "slide", "1 0 0"),),
        0.7, "0.0 -0.1 0.01", "0.006 0.002 0.005 0.0005 0.0002 0.0003",
    ),
    Body(
        "leg", "torso", "0.0 -0.4 -0.1", "0.0 0.3 0.2", (("hip", "hinge", "0 0 1"),),
        6.0, "0.0 -0.2 0.0", "0.12 0.02 0.12 0.01 0.004 -0.006",
    ),
)  # fmt: skip
COORDINATES = [joint[0] for body in BODIES for joint in body.joints]

# Name, body, shape, place in the body, its angles (as above), radius. Cylinders lie along their z axis; MuJoCo's have
# no ends, those of the OpenSim model are a metre long.
OBJECTS = (
    ("ball", "torso", "sphere", "0.05 0.32 0.22", "0 0 0", 0.04),
    ("roller", "torso", "cylinder", "0.02 -0.42 -0.1", "0.1 0.3 0", 0.05),
)
# Name, points as (body, place), and the object between the first two of them, if any.
STRINGS = (
    ("straight", (("ground", "0.3 0.8 0.1"), ("torso", "0.1 0.2 0.0"), ("rod", "0.0 -0.15 0.02")), None),
    ("over_ball", (("torso", "0.14 0.4 0.2"), ("arm", "0.06 -0.2 0.05")), "ball"),
    ("over_roller", (("torso", "0.12 -0.2 -0.12"), ("leg", "0.03 -0.25 0.03")), "roller"),
)


def osim(strings=True):
    """Every string is a muscle: strings of their own the format does not have."""
    wraps = {
        body: "".join(osim_object(*object_) for object_ in OBJECTS if object_[1] == body)
        for body in {object_[1] for object_ in OBJECTS}
    }
    bodies = "".join(
        f"""<Body name="{b.name}"><WrapObjectSet><objects>{wraps.get(b.name, "")}</objects></WrapObjectSet>
        <mass>{b.mass}</mass><mass_center>{b.mass_center}</mass_center><inertia>{b.inertia}</inertia></Body>"""
        for b in BODIES
    )
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<OpenSimDocument Version="40000"><Model name="tree"><gravity>{GRAVITY}</gravity>
<BodySet><objects>{bodies}</objects></BodySet>
<JointSet><objects>{"".join(map(osim_joint, BODIES))}</objects></JointSet>
<ForceSet><objects>{"".join(osim_string(*string) for string in STRINGS if strings)}</objects></ForceSet>
</Model></OpenSimDocument>"""


def osim_path(body):
    return "/ground" if body == "ground" else f"/bodyset/{body}"


def osim_object(name, _, shape, place, angles, radius):
    kind = {"sphere": "WrapSphere", "cylinder": "WrapCylinder"}[shape]
    length = "<length>1</length>" if shape == "cylinder" else ""
    return f"""<{kind} name="{name}"><active>true</active><xyz_body_rotation>{angles}</xyz_body_rotation>
    <translation>{place}</translation><quadrant>all</quadrant><radius>{radius}</radius>{length}</{kind}>"""


def osim_joint(body):
    names = [name for name, _, _ in body.joints]
    coordinates = "".join(f'<Coordinate name="{name}"><clamped>false</clamped></Coordinate>' for name in names)
    axes = ""
    for word, kind in (("rotation", "hinge"), ("translation", "slide")):
        moving = [(name, axis) for name, joint_kind, axis in body.joints if joint_kind == kind]
        # The format wants three axes that are not parallel: those that nothing moves along are the units left over.
        taken = [axis for _, axis in moving]
        still = [("", axis) for axis in ("1 0 0", "0 1 0", "0 0 1") if axis not in taken]
        for i, (coordinate, axis) in enumerate(moving + still, 1):
            function = '<LinearFunction name="function"><coefficients>1 0</coefficients></LinearFunction>'
            if not coordinate:
                function = '<Constant name="function"><value>0</value></Constant>'
            axes += f"""<TransformAxis name="{word}{i}"><coordinates>{coordinate}</coordinates><axis>{axis}</axis>
            {function}</TransformAxis>"""
    return f"""<CustomJoint name="{body.name}_joint"><socket_parent_frame>at</socket_parent_frame>
    <socket_child_frame>/bodyset/{body.name}</socket_child_frame><coordinates>{coordinates}</coordinates>
    <frames><PhysicalOffsetFrame name="at"><socket_parent>{osim_path(body.parent)}</socket_parent>
    <translation>{body.position}</translation><orientation>{body.angles}</orientation></PhysicalOffsetFrame></frames>
    <SpatialTransform>{axes}</SpatialTransform></CustomJoint>"""


def osim_string(name, points, object_):
    path = "".join(
        f"""<PathPoint name="{name}_{i}"><socket_parent_frame>{osim_path(body)}</socket_parent_frame>
        <location>{place}</location></PathPoint>"""
        for i, (body, place) in enumerate(points)
    )
    wraps = f'<PathWrap name="wrap"><wrap_object>{object_}</wrap_object></PathWrap>' if object_ else ""
    return f"""<Millard2012EquilibriumMuscle name="{name}"><max_isometric_force>100</max_isometric_force>
    <optimal_fiber_length>0.1</optimal_fiber_length><tendon_slack_length>0.2</tendon_slack_length>
    <GeometryPath name="path"><PathPointSet><objects>{path}</objects></PathPointSet>
    <PathWrapSet><objects>{wraps}</objects></PathWrapSet></GeometryPath></Millard2012EquilibriumMuscle>"""


def mjcf():
    def inside(name):
        parts = "".join(
            f'<geom name="{n}" type="{shape}" pos="{place}" euler="{angles}" size="{radius} 0.5" mass="0"/>'
            for n, body, shape, place, angles, radius in OBJECTS
            if body == name
        )
        parts += "".join(
            f'<site name="{n}_{i}" pos="{place}"/>'
            for n, points, _ in STRINGS
            for i, (body, place) in enumerate(points)
            if body == name
        )
        return parts + "".join(body_of(b) for b in BODIES if b.parent == name)

    def body_of(b):
        joints = "".join(f'<joint name="{n}" type="{kind}" axis="{axis}"/>' for n, kind, axis in b.joints)
        inertial = f'<inertial pos="{b.mass_center}" mass="{b.mass}" fullinertia="{b.inertia}"/>'
        return f'<body name="{b.name}" pos="{b.position}" euler="{b.angles}">{joints}{inertial}{inside(b.name)}</body>'

    strings = ""
    for name, points, object_ in STRINGS:
        steps = [f'<site site="{name}_{i}"/>' for i in range(len(points))]
        if object_:
            steps.insert(1, f'<geom geom="{object_}"/>')
        strings += f'<spatial name="{name}">{"".join(steps)}</spatial>'
    return f"""<mujoco><compiler angle="radian" eulerseq="xyz" inertiafromgeom="false"/>
<option gravity="{GRAVITY}" timestep="1e-3" integrator="RK4"><flag contact="disable"/></option>
<worldbody>{inside("ground")}</worldbody><tendon>{strings}</tendon></mujoco>"""


class MujocoTree:
    """MuJoCo's side. Its generalised positions are the coordinates, in their order."""

    def __init__(self):
        self.model = mujoco.MjModel.from_xml_string(mjcf())
        self.data = mujoco.MjData(self.model)
        assert [self.model.joint(i).name for i in range(self.model.njnt)] == COORDINATES

    def put(self, q, qdot, qddot=None):
        self.data.qpos[:], self.data.qvel[:] = q, qdot
        if qddot is not None:
            self.data.qacc[:] = qddot

    def inverse_dynamics(self, q, qdot, qddot):
        self.put(q, qdot, qddot)
        mujoco.mj_inverse(self.model, self.data)
        return self.data.qfrc_inverse.copy()

    def strings(self, q):
        """Lengths, moment arms (strings by coordinates: -dL/dq), and which strings touch their object."""
        self.put(q, numpy.zeros(len(q)))
        mujoco.mj_forward(self.model, self.data)
        m, d = self.model, self.data
        slopes = numpy.zeros((m.ntendon, m.nv))
        for i in range(m.ntendon):
            entries = slice(m.ten_J_rowadr[i], m.ten_J_rowadr[i] + m.ten_J_rownnz[i])
            slopes[i, m.ten_J_colind[entries]] = d.ten_J[entries]
        # Points on an object are numbered by it; sites and the end of a string by -1 and -2.
        ends = [slice(a, a + n) for a, n in zip(d.ten_wrapadr, d.ten_wrapnum, strict=True)]
        touching = [bool((d.wrap_obj.ravel()[points] >= 0).any()) for points in ends]
        return d.ten_length.copy(), -slopes, touching

    def moves(self, q, qdot, time):
        """Coordinates at times a millisecond apart of a motion without any force but gravity."""
        mujoco.mj_resetData(self.model, self.data)
        self.put(q, qdot)
        rows = [self.data.qpos.copy()]
        for _ in time[1:]:
            mujoco.mj_step(self.model, self.data)
            rows.append(self.data.qpos.copy())
        assert abs(self.data.time - time[-1]) < 1e-9
        return numpy.array(rows)
