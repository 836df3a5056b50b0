// Selective mass scaling: the few nodes that set the time step are made heavier, by so little that the canopy
// does not notice (Olovsson, Simonsson and Unosson 2005 call the plain form of it conventional).
#pragma once

#include "fullsim/mesh/mesh.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute::fullsim {

/// Result of mass scaling.
struct MassScaling {
    double mass = 0.0;    ///< [kg] added
    double share = 0.0;   ///< [-] of the canopy with its steady air
    int nodes = 0;        ///< that it was added to
    double longer = 1.0;  ///< by which the bound on the step grew, unstrained and without air
};

/// Adds `share` of the canopy's mass and of `air` [kg], no more and no less, to the canopy nodes with the
/// smallest bounds on the critical time step, so that all of these have the same bound: no other distribution
/// of that mass makes it larger. Counts each of the scene's stages in proportion to its own bound, unstrained
/// and without added mass, where the bound is smallest. Lines that take subcycles hold no node back. The mass
/// added has weight, too.
MassScaling scale_masses(const Scene& scene, double share, double air, Mesh& mesh);

}  // namespace twinchute::fullsim
