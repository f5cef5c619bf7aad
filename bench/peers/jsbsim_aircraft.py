"""JSBSim's side of the comparisons: an exported aircraft over a flat planet, its loads at a state, and its flight.

JSBSim's body axes are ours (x forward, y right, z down); its numbers are feet, pounds and slugs. By itself it flies
round a turning earth with WGS84 gravity: `flat_planet.xml` takes that away, so that gravity is 9.80665 m/s^2 and local
axes do not turn, as in the program's simulations. The atmosphere is the standard one on both sides."""

import pathlib
import xml.etree.ElementTree as ElementTree

import jsbsim
import numpy

FOOT = 0.3048
POUND = 4.4482216152605
SURFACES = ("elevator", "aileron", "rudder")
FLAT_PLANET = pathlib.Path(__file__).with_name("flat_planet.xml")
# Columns of truth.csv, JSBSim's names of the same, and what one of JSBSim's units is in SI.
START = {
    "ic/phi-rad": ("roll", 1.0),
    "ic/theta-rad": ("pitch", 1.0),
    "ic/psi-true-rad": ("yaw", 1.0),
    "ic/vn-fps": ("vel_north", FOOT),
    "ic/ve-fps": ("vel_east", FOOT),
    "ic/vd-fps": ("vel_down", FOOT),
    "ic/p-rad_sec": ("gyro_x", 1.0),
    "ic/q-rad_sec": ("gyro_y", 1.0),
    "ic/r-rad_sec": ("gyro_z", 1.0),
}
STATES = {
    "airspeed": ("velocities/vt-fps", FOOT),
    "alpha": ("aero/alpha-rad", 1.0),
    "beta": ("aero/beta-rad", 1.0),
    "gyro_x": ("velocities/p-rad_sec", 1.0),
    "gyro_y": ("velocities/q-rad_sec", 1.0),
    "gyro_z": ("velocities/r-rad_sec", 1.0),
    "roll": ("attitude/phi-rad", 1.0),
    "pitch": ("attitude/theta-rad", 1.0),
    "vel_north": ("velocities/v-north-fps", FOOT),
    "vel_east": ("velocities/v-east-fps", FOOT),
    "vel_down": ("velocities/v-down-fps", FOOT),
    "elevator": ("fcs/elevator-pos-rad", 1.0),
    "aileron": ("fcs/left-aileron-pos-rad", 1.0),
    "rudder": ("fcs/rudder-pos-rad", 1.0),
    "air_density": ("atmosphere/rho-slugs_ft3", POUND / FOOT**4),
}
# Forces and moments of air and thrust: what the file's functions and JSBSim's own sums make of the state.
LOADS = {
    "force_x": (("forces/fbx-aero-lbs", "forces/fbx-external-lbs"), POUND),
    "force_y": (("forces/fby-aero-lbs", "forces/fby-external-lbs"), POUND),
    "force_z": (("forces/fbz-aero-lbs", "forces/fbz-external-lbs"), POUND),
    "moment_x": (("moments/l-aero-lbsft", "moments/l-external-lbsft"), POUND * FOOT),
    "moment_y": (("moments/m-aero-lbsft", "moments/m-external-lbsft"), POUND * FOOT),
    "moment_z": (("moments/n-aero-lbsft", "moments/n-external-lbsft"), POUND * FOOT),
}


class JsbsimAircraft:
    """An exported file in JSBSim. Rows are those of truth.csv."""

    def __init__(self, exported, folder, step):
        home = pathlib.Path(folder) / "aircraft" / "peer"
        home.mkdir(parents=True)
        (home / "peer.xml").write_bytes(pathlib.Path(exported).read_bytes())
        self.fdm = jsbsim.FGFDMExec(None)
        self.fdm.set_debug_level(0)
        self.fdm.set_aircraft_path(str(home.parent))
        assert self.fdm.load_planet(str(FLAT_PLANET), False)
        assert self.fdm.load_model("peer"), "JSBSim does not load the file"
        self.fdm.set_dt(step)
        self.stops = {}
        for channel in ElementTree.parse(exported).iter("channel"):
            stops = channel.find("actuator/clipto")
            if stops is not None:
                self.stops[channel.get("name")] = (float(stops.findtext("min")), float(stops.findtext("max")))
        assert set(self.stops) == set(SURFACES)

    def command(self, row):
        """Deflections and throttle."""
        for surface in SURFACES:
            low, high = self.stops[surface]
            self.fdm[f"fcs/{surface}-cmd-norm"] = row[surface] / (high if row[surface] > 0.0 else -low)
        self.fdm["fcs/throttle-cmd-norm"] = row["throttle"]

    def start(self, row):
        """Pose, velocity and rates of a row, its deflections and throttle commanded."""
        self.fdm["ic/h-sl-ft"] = -row["pos_down"] / FOOT
        for name, (column, unit) in START.items():
            self.fdm[name] = row[column] / unit
        self.command(row)
        assert self.fdm.run_ic()

    def states(self):
        return {name: self.fdm[property_] * unit for name, (property_, unit) in STATES.items()}

    def loads(self):
        return {name: sum(self.fdm[p] for p in properties) * unit for name, (properties, unit) in LOADS.items()}

    def fly(self, rows):
        """From the first row on, one step from row to row, with their deflections; states by row."""
        self.start(rows[0])
        flown = [self.states()]
        for row in rows[1:]:
            self.command(row)
            assert self.fdm.run()
            flown.append(self.states())
        return {name: numpy.array([state[name] for state in flown]) for name in STATES}
