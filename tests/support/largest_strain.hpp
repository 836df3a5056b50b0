// How far a mesh stretches its fabric as it is placed.
#pragma once

#include <Eigen/Dense>
#include <algorithm>

#include "fullsim/mesh/mesh.hpp"

namespace twinchute::fullsim {

/// Largest length over that of the cut in any triangle, less one.
inline double largest_strain(const Mesh& mesh) {
    double largest = -1.0;
    for (const Triangle& t : mesh.triangles) {
        Eigen::Matrix<double, 3, 2> edges;
        edges << mesh.position[t.node[1]] - mesh.position[t.node[0]],
            mesh.position[t.node[2]] - mesh.position[t.node[0]];
        Eigen::Matrix2d cut;
        cut << t.a, t.b, 0.0, t.c;
        const Eigen::Matrix<double, 3, 2> gradient = edges * cut.inverse();
        largest = std::max(largest, Eigen::JacobiSVD<Eigen::MatrixXd>(gradient).singularValues()[0] - 1.0);
    }
    return largest;
}

}  // namespace twinchute::fullsim
