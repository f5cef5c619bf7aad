#pragma once

#include <cmath>
#include <string>

#include "veridyn/muscle/osim/osim_reader.hpp"

namespace veridyn::muscle {

/// A mass of 2 kg on a vertical slider above a floor, gravity 10 m/s^2, a ball of 10 cm around it, with the elements
/// `forces` of a ForceSet.
inline Model on_a_slider(const std::string& forces) {
  return OsimFile::parse(
             R"(<OpenSimDocument Version="40000"><Model name="m"><gravity>0 -10 0</gravity><BodySet><objects>
<Body name="mass"><mass>2</mass><inertia>0.1 0.1 0.1 0 0 0</inertia></Body></objects></BodySet>
<JointSet><objects><SliderJoint name="rail"><socket_parent_frame>up</socket_parent_frame>
<socket_child_frame>along</socket_child_frame><coordinates><Coordinate name="height"/></coordinates>
<frames><PhysicalOffsetFrame name="up"><socket_parent>/ground</socket_parent><orientation>0 0 1.5707963267948966
</orientation></PhysicalOffsetFrame><PhysicalOffsetFrame name="along"><socket_parent>/bodyset/mass</socket_parent>
<orientation>0 0 1.5707963267948966</orientation></PhysicalOffsetFrame></frames></SliderJoint></objects></JointSet>
<ContactGeometrySet><objects><ContactHalfSpace name="floor"><socket_frame>/ground</socket_frame><orientation>
0 0 -1.5707963267948966</orientation></ContactHalfSpace><ContactSphere name="ball"><socket_frame>/bodyset/mass
</socket_frame><radius>0.1</radius></ContactSphere></objects></ContactGeometrySet>
<ForceSet><objects>)" +
                 forces + "</objects></ForceSet></Model></OpenSimDocument>",
             "m.osim")
      .model();
}

/// That ball against the floor, stiffness 1e5. @param dissipation  [s/m]
inline std::string ball_on_floor(const std::string& dissipation, const std::string& name = "c") {
  return "<HuntCrossleyForce name=\"" + name +
         "\"><HuntCrossleyForce::ContactParametersSet name=\"contact_parameters\"><objects>"
         "<HuntCrossleyForce::ContactParameters><geometry>floor "
         "ball</geometry><stiffness>1e5</stiffness><dissipation>" +
         dissipation +
         "</dissipation></HuntCrossleyForce::ContactParameters></objects></HuntCrossleyForce::ContactParametersSet>"
         "</HuntCrossleyForce>";
}

/// Its force is kBallStiffness depth^(3/2): two bodies of 1e5 each, in series after Hertz.
inline const double kBallStiffness = 4.0 / 3.0 * 1e5 / std::pow(2.0, 1.5) * std::sqrt(0.1);

}  // namespace veridyn::muscle
