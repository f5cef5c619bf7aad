"""JSBSim's side: an exported aircraft over a flat planet, its loads at a state, and its flight.

JSBSim's body axes are ours (x forward, y right, z down); its numbers are feet, pounds and slugs. By default it flies
round a turning earth with WGS84 gravity: `flat_planet.xml` takes that away, so that gravity is 9.80665 m/s^2 and local
axes do not turn, as in the program's simulations. The atmosphere is the standard one on both sides."""

import pathlib

import jsbsim
import numpy

FOOT = 0.3048
POUND = 4.4482216152605
SURFACES = ("elevator", "aileron", "rudder")
POSITIONS = ("fcs/elevator-pos-rad", "fcs/left-aileron-pos-rad", "fcs/rudder-pos-rad")
FLAT_PLANET = pathlib.Path(__file__).with_name("flat_planet.xml")


class JsbsimAircraft:
    """An exported file in JSBSim."""

    def __init__(self, exported, folder, step):
        home = pathlib.Path(folder) / "aircraft" / "peer"
        home.mkdir(parents=True)
        (home / "peer.xml").write_bytes(pathlib.Path(exported).read_bytes())
        jsbsim.FGJSBBase().debug_lvl = 0
        self.fdm = jsbsim.FGFDMExec(None)
        self.fdm.set_debug_level(0)
        self.fdm.set_aircraft_path(str(home.parent))
        assert self.fdm.load_planet(str(FLAT_PLANET), False)
        assert self.fdm.load_model("peer"), "JSBSim does not load the file"
        self.fdm.set_dt(step)
        stops = {}
        for surface in SURFACES:
            stops[surface] = None
        self.stops = stops

    def start(self, row):
        """At a row of truth.csv: pose, velocity, rates; deflections and throttle are commanded."""
        fdm = self.fdm
        for name in ("roll", "pitch", "yaw"):
            fdm[{"roll": "ic/phi-rad", "pitch": "ic/theta-rad", "yaw": "ic/psi-true-rad"}[name]] = row[name]
        fdm["ic/lat-gc-rad"], fdm["ic/long-gc-rad"] = 0.0, 0.0
        fdm["ic/h-sl-ft"] = -row["pos_down"] / FOOT
        for name, axis in (("ic/vn-fps", "vel_north"), ("ic/ve-fps", "vel_east"), ("ic/vd-fps", "vel_down")):
            fdm[name] = row[axis] / FOOT
        for name, axis in (("ic/p-rad_sec", "gyro_x"), ("ic/q-rad_sec", "gyro_y"), ("ic/r-rad_sec", "gyro_z")):
            fdm[name] = row[axis]
        self.command(row)
        assert fdm.run_ic()
