#pragma once
// Since when MuJoCo's XML has what 2.2.2 does not know, by its changelog, and what says the
// same in 2.2.2.

#include <array>
#include <string_view>

namespace mjdiag {

struct NewerEntry {
  std::string_view element;    ///< empty: any
  std::string_view attribute;  ///< empty: the element itself
  std::string_view keyword;  ///< of the attribute's value; empty: the attribute itself
  std::string_view version;
  std::string_view instead;
};

inline constexpr std::string_view kLeaveOut = "leave it out";
inline constexpr std::string_view kForViewers = "leave it out, it is for viewers";
inline constexpr std::string_view kDeformable =
    "leave it out, there are no deformable bodies";
inline constexpr std::string_view kAffine =
    "<general biastype=\"affine\" gainprm=\"KP\" biasprm=\"0 -KP -KV\"/>";

inline constexpr std::array kNewerEntries{
    NewerEntry{"extension", "", "", "2.3.0", "leave it out, there are no plugins"},
    NewerEntry{"plugin", "", "", "2.3.0", "leave it out, there are no plugins"},
    NewerEntry{"frame", "", "", "3.1.0",
               "its content, with the frame's pose in each pos and quat"},
    NewerEntry{"replicate", "", "", "3.1.5", "its content, written out"},
    NewerEntry{"attach", "", "", "3.2.0", "the other model's bodies, by <include>"},
    NewerEntry{"model", "", "", "3.2.0", "the other model's bodies, by <include>"},
    NewerEntry{"flexcomp", "", "", "3.0.0", kDeformable},
    NewerEntry{"deformable", "", "", "3.0.0", kDeformable},
    NewerEntry{"jointactuatorfrc", "", "", "2.3.7",
               "<actuatorfrc> of the joint's actuator"},
    NewerEntry{"camprojection", "", "", "3.0.0", kLeaveOut},
    NewerEntry{"distance", "", "", "3.1.6", kLeaveOut},
    NewerEntry{"normal", "", "", "3.1.6", kLeaveOut},
    NewerEntry{"fromto", "", "", "3.1.6", kLeaveOut},
    NewerEntry{"layer", "", "", "3.2.1", kForViewers},
    NewerEntry{"compiler", "assetdir", "", "2.3.0", "meshdir and texturedir"},
    NewerEntry{"compiler", "alignfree", "", "3.2.3", kLeaveOut},
    NewerEntry{"option", "integrator", "implicitfast", "2.3.3", "implicit"},
    NewerEntry{"option", "ls_iterations", "", "3.0.0", kLeaveOut},
    NewerEntry{"option", "ls_tolerance", "", "3.0.0", kLeaveOut},
    NewerEntry{"option", "actuatorgroupdisable", "", "3.0.1", kLeaveOut},
    NewerEntry{"option", "ccd_iterations", "", "3.2.3", "mpr_iterations"},
    NewerEntry{"option", "ccd_tolerance", "", "3.2.3", "mpr_tolerance"},
    NewerEntry{"flag", "eulerdamp", "", "3.0.0", kLeaveOut},
    NewerEntry{"flag", "invdiscrete", "", "3.0.0", kLeaveOut},
    NewerEntry{"flag", "island", "", "3.0.0", kLeaveOut},
    NewerEntry{"flag", "autoreset", "", "3.2.1", kLeaveOut},
    NewerEntry{"flag", "nativeccd", "", "3.2.3", kLeaveOut},
    NewerEntry{"size", "memory", "", "2.3.0", "njmax and nconmax, or nothing"},
    NewerEntry{"global", "realtime", "", "2.3.0", kForViewers},
    NewerEntry{"global", "ellipsoidinertia", "", "2.3.4", kForViewers},
    NewerEntry{"global", "bvactive", "", "3.1.2", kForViewers},
    NewerEntry{"global", "orthographic", "", "3.2.0", kForViewers},
    NewerEntry{"rgba", "bv", "", "3.1.2", kForViewers},
    NewerEntry{"rgba", "bvactive", "", "3.1.2", kForViewers},
    NewerEntry{"body", "gravcomp", "", "2.3.1",
               "leave it out, with <flag gravity=\"disable\"/> where it is 1 of all "
               "bodies that move"},
    NewerEntry{"joint", "actuatorforcerange", "", "2.3.7",
               "forcerange of its actuators"},
    NewerEntry{"joint", "actuatorforcelimited", "", "2.3.7",
               "forcelimited of its actuators"},
    NewerEntry{"joint", "actuatorfrcrange", "", "3.0.0", "forcerange of its actuators"},
    NewerEntry{"joint", "actuatorfrclimited", "", "3.0.0",
               "forcelimited of its actuators"},
    NewerEntry{"joint", "actuatorgravcomp", "", "3.1.4", kLeaveOut},
    NewerEntry{"freejoint", "align", "", "3.2.3", kLeaveOut},
    NewerEntry{"", "actearly", "", "3.0.0", kLeaveOut},
    NewerEntry{"general", "actdim", "", "2.3.1", kLeaveOut},
    NewerEntry{"general", "dyntype", "filterexact", "3.0.0", "filter"},
    NewerEntry{"position", "kv", "", "3.1.0", kAffine},
    NewerEntry{"intvelocity", "kv", "", "3.1.0", kAffine},
    NewerEntry{"position", "dampratio", "", "3.1.6", kAffine},
    NewerEntry{"intvelocity", "dampratio", "", "3.1.6", kAffine},
    NewerEntry{"position", "timeconst", "", "3.1.6",
               "<general dyntype=\"filter\" dynprm=\"TIMECONST\" biastype=\"affine\" "
               "gainprm=\"KP\" biasprm=\"0 -KP\"/>"},
    NewerEntry{"position", "inheritrange", "", "3.1.3", "ctrlrange, that of its joint"},
    NewerEntry{"intvelocity", "inheritrange", "", "3.1.3",
               "actrange, that of its joint"},
    NewerEntry{"muscle", "tausmooth", "", "2.3.6", kLeaveOut},
    NewerEntry{"pair", "solreffriction", "", "2.3.6", kLeaveOut},
    NewerEntry{"connect", "site1", "", "3.2.3", "body1, body2 and anchor"},
    NewerEntry{"connect", "site2", "", "3.2.3", "body1, body2 and anchor"},
    NewerEntry{"weld", "site1", "", "3.2.3", "body1, body2 and anchor"},
    NewerEntry{"weld", "site2", "", "3.2.3", "body1, body2 and anchor"},
    NewerEntry{"geom", "type", "sdf", "3.0.0", "another type"},
    NewerEntry{"mesh", "maxhullvert", "", "3.2.0", kLeaveOut},
    NewerEntry{"", "content_type", "", "2.3.7", kLeaveOut},
    NewerEntry{"hfield", "elevation", "", "3.1.2", "a PNG as file"},
    NewerEntry{"material", "metallic", "", "3.1.5", kForViewers},
    NewerEntry{"material", "roughness", "", "3.1.5", kForViewers},
    NewerEntry{"light", "bulbradius", "", "3.1.5", kForViewers},
    NewerEntry{"camera", "orthographic", "", "3.2.0", kForViewers},
    NewerEntry{"camera", "resolution", "", "3.0.0", kForViewers},
    NewerEntry{"camera", "focal", "", "3.0.0", kForViewers},
    NewerEntry{"camera", "focalpixel", "", "3.0.0", kForViewers},
    NewerEntry{"camera", "principal", "", "3.0.0", kForViewers},
    NewerEntry{"camera", "principalpixel", "", "3.0.0", kForViewers},
    NewerEntry{"camera", "sensorsize", "", "3.0.0", kForViewers},
};

}  // namespace mjdiag
