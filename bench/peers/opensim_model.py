"""OpenSim's side of the comparisons: a model, its pose, and what OpenSim makes of it."""

import numpy
import opensim

opensim.Logger.setLevelString("Off")


class OpenSimModel:
    """A model file in OpenSim; forces other than gravity can be switched off."""

    def __init__(self, path, without_forces=False):
        self.model = opensim.Model(str(path))
        self.model.initSystem()
        if without_forces:
            forces = self.model.updForceSet()
            for i in range(forces.getSize()):
                forces.get(i).set_appliesForce(False)
        self.refresh()

    def refresh(self):
        """To be called after a change of the model."""
        self.state = self.model.initSystem()
        coordinates = self.model.getCoordinateSet()
        self.coordinates = [coordinates.get(i) for i in range(coordinates.getSize())]
        self.names = [c.getName() for c in self.coordinates]
        self.muscles = [self.model.getMuscles().get(i) for i in range(self.model.getMuscles().getSize())]
        for c in self.coordinates:
            c.setLocked(self.state, False)
        # OpenSim orders speeds by the multibody tree, not by the set of coordinates.
        self.speed_index = []
        self.model.realizePosition(self.state)
        for c in self.coordinates:
            self.state.setU(opensim.Vector(self.state.getNU(), 0.0))
            c.setSpeedValue(self.state, 1.0)
            self.speed_index.append(int(numpy.argmax(self.state.getU().to_numpy())))
        self.state.setU(opensim.Vector(self.state.getNU(), 0.0))

    def couplers(self):
        constraints = self.model.getConstraintSet()
        found = (
            opensim.CoordinateCouplerConstraint.safeDownCast(constraints.get(i)) for i in range(constraints.getSize())
        )
        return [coupler for coupler in found if coupler is not None]

    def led(self):
        """Names of coordinates that others lead."""
        return [coupler.getDependentCoordinateName() for coupler in self.couplers()]

    def with_couplers(self, q):
        """Poses in which coordinates that others lead are where their couplers put them."""
        q = numpy.array(q)
        for coupler in self.couplers():
            led = self.names.index(coupler.getDependentCoordinateName())
            leader = self.names.index(coupler.getIndependentCoordinateNames().get(0))
            function = coupler.getFunction()
            q[:, led] = [function.calcValue(opensim.Vector(1, float(x))) for x in q[:, leader]]
        return q

    def moving_with_couplers(self, q, qdot, qddot):
        """The same of states, with speeds and accelerations."""
        q, qdot, qddot = self.with_couplers(q), numpy.array(qdot), numpy.array(qddot)
        once, twice = opensim.StdVectorInt([0]), opensim.StdVectorInt([0, 0])
        for coupler in self.couplers():
            led = self.names.index(coupler.getDependentCoordinateName())
            leader = self.names.index(coupler.getIndependentCoordinateNames().get(0))
            function = coupler.getFunction()
            at = [opensim.Vector(1, float(x)) for x in q[:, leader]]
            slope, curvature = (numpy.array([function.calcDerivative(d, x) for x in at]) for d in (once, twice))
            qdot[:, led] = slope * qdot[:, leader]
            qddot[:, led] = slope * qddot[:, leader] + curvature * qdot[:, leader] ** 2
        return q, qdot, qddot

    def pose(self, q):
        for c, value in zip(self.coordinates, q, strict=True):
            c.setValue(self.state, float(value), False)
        self.model.realizePosition(self.state)

    def lengths(self):
        return numpy.array([m.getLength(self.state) for m in self.muscles])

    def wrap_points(self):
        """How many points of each muscle's path lie on wrap objects, in the pose: two on each that it touches."""
        counts = []
        for m in self.muscles:
            path = m.getGeometryPath().getCurrentPath(self.state)
            counts.append(sum(path.get(i).getConcreteClassName() == "PathWrapPoint" for i in range(path.getSize())))
        return counts

    def moment_arms(self):
        """Muscles by coordinates: the work of the tension, as OpenSim defines them [m]."""
        return numpy.array([[m.computeMomentArm(self.state, c) for c in self.coordinates] for m in self.muscles])

    def length_slopes(self, q, step=1e-5):
        """Muscles by coordinates: -dL/dq of OpenSim's own lengths, by central differences [m]."""
        slopes = numpy.empty((len(self.muscles), len(q)))
        for k in range(len(q)):
            ends = []
            for h in (step, -step):
                moved = numpy.array(q, dtype=float)
                moved[k] += h
                self.pose(moved)
                ends.append(self.lengths())
            slopes[:, k] = (ends[1] - ends[0]) / (2.0 * step)
        self.pose(q)
        return slopes

    def inverse_dynamics(self, q, qdot, qddot):
        """Generalised forces in the order of the coordinates [N m or N]."""
        self.pose(q)
        speeds, accelerations = (opensim.Vector(self.state.getNU(), 0.0) for _ in range(2))
        for i, index in enumerate(self.speed_index):
            speeds.set(index, float(qdot[i]))
            accelerations.set(index, float(qddot[i]))
        self.state.setU(speeds)
        self.model.realizeVelocity(self.state)
        forces = opensim.InverseDynamicsSolver(self.model).solve(self.state, accelerations)
        return numpy.array([forces.get(index) for index in self.speed_index])

    def default_pose(self):
        return {name: c.getDefaultValue() for name, c in zip(self.names, self.coordinates, strict=True)}


def constant(value):
    return opensim.Constant(value)


def held(steps):
    """The values of (time, value) until the next; the first at 0."""
    function = opensim.PiecewiseConstantFunction()
    for time, value in steps:
        function.addPoint(time, value)
    return function


def sine(amplitude, rate_rad_s, phase, mean):
    return opensim.Sine(amplitude, rate_rad_s, phase, mean)


def prescribe(model, excitations):
    """A controller of excitations, which are OpenSim functions of time by muscle."""
    controller = opensim.PrescribedController()
    controller.setName("excitations")
    for muscle in model.muscles:
        controller.addActuator(muscle)
        controller.prescribeControlForActuator(muscle.getName(), excitations[muscle.getName()])
    model.model.addController(controller)
    model.refresh()


def simulate(model, pose, excitations, time, accuracy=1e-8):
    """A forward simulation from rest in a pose, activations at the first excitations and fibres in equilibrium.

    Columns by the names of coordinates, and of each muscle its activation, fibre length and tendon force."""
    at_start = {name: f.calcValue(opensim.Vector(1, 0.0)) for name, f in excitations.items()}
    prescribe(model, excitations)
    state = model.model.initSystem()
    for c, value in zip(model.coordinates, pose, strict=True):
        c.setValue(state, float(value), False)
        c.setSpeedValue(state, 0.0)
    for muscle in model.muscles:
        muscle.setActivation(state, at_start[muscle.getName()])
    model.model.equilibrateMuscles(state)
    manager = opensim.Manager(model.model)
    manager.setIntegratorAccuracy(accuracy)
    manager.initialize(state)
    names = ["time", *model.names]
    for m in model.muscles:
        names += [f"{m.getName()}_{what}" for what in ("activation", "fiber_length", "tendon_force")]
    rows = []
    for t in time:
        if t > 0.0:
            state = manager.integrate(float(t))
        model.model.realizeDynamics(state)
        row = [state.getTime(), *(c.getValue(state) for c in model.coordinates)]
        for m in model.muscles:
            row += [m.getActivation(state), m.getFiberLength(state), m.getTendonForce(state)]
        rows.append(row)
    return dict(zip(names, numpy.array(rows).T, strict=True))


def random_states(model, count, seed):
    """Poses within the coordinates' ranges, speeds and accelerations: three arrays, a row a state.

    Ranges of more than two metres or five turns are of bodies that are free: there 1 m or 1 rad about the default."""
    random = numpy.random.default_rng(seed)
    q, qdot, qddot = [], [], []
    for c in model.coordinates:
        low, high = c.getRangeMin(), c.getRangeMax()
        if high - low > 10.0 or (c.getMotionType() == opensim.Coordinate.Translational and high - low > 2.0):
            low, high = c.getDefaultValue() - 0.5, c.getDefaultValue() + 0.5
        q.append(random.uniform(low, high, count))
        qdot.append(random.uniform(-4.0, 4.0, count))
        qddot.append(random.uniform(-20.0, 20.0, count))
    return numpy.array(q).T, numpy.array(qdot).T, numpy.array(qddot).T


def read_storage(path):
    """Columns of an OpenSim storage file by name. The names may go over several lines (states of CMCTool)."""
    lines = path.read_text().splitlines()
    rows = [line.split() for line in lines[lines.index("endheader") + 1 :] if line.strip()]
    first = next(i for i, row in enumerate(rows) if row[0][0] in "-.0123456789")
    names = [name for row in rows[:first] for name in row]
    return dict(zip(names, numpy.array(rows[first:], dtype=float).T, strict=True))


def write_motion(path, columns):
    """A .mot file in radians and metres."""
    table = numpy.column_stack(list(columns.values()))
    header = f"motion\nversion=1\nnRows={len(table)}\nnColumns={table.shape[1]}\ninDegrees=no\nendheader\n"
    rows = "\n".join("\t".join(repr(float(x)) for x in row) for row in table)
    path.write_text(header + "\t".join(columns) + "\n" + rows + "\n")


def static_optimization(path, motion, folder, reserves, physiology=True, begin=0.0, end=1.0):
    """OpenSim's StaticOptimization (AnalyzeTool) of a .mot file: least sum of squared activations; reserves are
    {coordinate: optimal force}. Activations of muscles, and `COORDINATE_reserve` in newton metres or newtons."""
    model = opensim.Model(str(path))
    model.initSystem()
    for coordinate, force in reserves.items():
        reserve = opensim.CoordinateActuator(coordinate)
        reserve.setName(f"{coordinate}_reserve")
        reserve.setOptimalForce(force)
        reserve.setMinControl(-1e6)
        reserve.setMaxControl(1e6)
        model.addForce(reserve)
    model.finalizeConnections()
    model.initSystem()
    analysis = opensim.StaticOptimization()
    analysis.setStartTime(begin)
    analysis.setEndTime(end)
    analysis.setStepInterval(1)
    analysis.setUseModelForceSet(True)
    analysis.setActivationExponent(2)
    analysis.setUseMusclePhysiology(physiology)
    analysis.setConvergenceCriterion(1e-8)
    analysis.setMaxIterations(1000)
    model.printToXML(str(folder / "model.osim"))
    tool = opensim.AnalyzeTool()
    tool.setName("peer")
    tool.setModelFilename(str(folder / "model.osim"))
    tool.setInitialTime(begin)
    tool.setFinalTime(end)
    tool.setCoordinatesFileName(str(motion))
    tool.setLowpassCutoffFrequency(-1)
    tool.setResultsDir(str(folder))
    tool.updAnalysisSet().cloneAndAppend(analysis)
    tool.printToXML(str(folder / "setup.xml"))
    tool = opensim.AnalyzeTool(str(folder / "setup.xml"))
    tool.run()
    activations = read_storage(folder / "peer_StaticOptimization_activation.sto")
    for coordinate, force in reserves.items():
        activations[f"{coordinate}_reserve"] *= force
    return activations


def computed_muscle_control(path, motion, folder, end):
    """OpenSim's CMCTool from 0 on, with windows of 10 ms, gains of 100 and 20, reserves of 1 N m everywhere: columns of
    its states, at its integrator's steps from 0.03 s on."""
    model = opensim.Model(str(path))
    model.initSystem()
    coordinates = [model.getCoordinateSet().get(i).getName() for i in range(model.getCoordinateSet().getSize())]
    tasks = opensim.CMC_TaskSet()
    for coordinate in coordinates:
        reserve = opensim.CoordinateActuator(coordinate)
        reserve.setName(f"{coordinate}_reserve")
        reserve.setOptimalForce(1.0)
        reserve.setMinControl(-1e3)
        reserve.setMaxControl(1e3)
        model.addForce(reserve)
        task = opensim.CMC_Joint()
        task.setName(coordinate)
        task.setCoordinateName(coordinate)
        task.setActive(True, False, False)
        for put, value in ((task.setWeight, 1.0), (task.setKP, 100.0), (task.setKV, 20.0), (task.setKA, 1.0)):
            put(value, 1.0, 1.0)
        tasks.cloneAndAppend(task)
    model.finalizeConnections()
    model.printToXML(str(folder / "model.osim"))
    tasks.printToXML(str(folder / "tasks.xml"))
    tool = opensim.CMCTool()
    tool.setName("peer")
    tool.setModelFilename(str(folder / "model.osim"))
    tool.setTaskSetFileName(str(folder / "tasks.xml"))
    tool.setDesiredKinematicsFileName(str(motion))
    tool.setLowpassCutoffFrequency(-1)
    tool.setInitialTime(0.0)
    # Its results end a window before.
    tool.setFinalTime(end + 0.02)
    tool.setTimeWindow(0.01)
    tool.setUseFastTarget(True)
    tool.setSolveForEquilibrium(True)
    tool.setErrorTolerance(1e-5)
    tool.setResultsDir(str(folder))
    tool.printToXML(str(folder / "setup.xml"))
    tool = opensim.CMCTool(str(folder / "setup.xml"))
    assert tool.run()
    return read_storage(folder / "peer_states.sto")
