#include "fullsim/mesh/hang_body.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fullsim/body.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

/// Cables from the payload up to where lines or other risers begin.
struct RiserChain {
    std::vector<std::size_t> cables;
    std::vector<NodeIndex> nodes;  // above each cable
    double rest_length = 0.0;      // [m]
};

std::vector<RiserChain> chains_of(const Mesh& mesh) {
    std::vector<std::vector<std::size_t>> at(mesh.position.size());
    for (std::size_t c = 0; c < mesh.cables.size(); ++c)
        for (const NodeIndex i : mesh.cables[c].node)
            at[i].push_back(c);
    std::vector<RiserChain> chains;
    for (const std::size_t first : at[mesh.payload()]) {
        RiserChain chain;
        NodeIndex here = mesh.payload();
        for (std::size_t c = first;;) {
            const Cable& cable = mesh.cables[c];
            here = cable.node[0] == here ? cable.node[1] : cable.node[0];
            chain.cables.push_back(c);
            chain.nodes.push_back(here);
            chain.rest_length += cable.rest_length;
            if (at[here].size() != 2) break;
            const std::size_t next = at[here][0] == c ? at[here][1] : at[here][0];
            if (mesh.cables[next].kind != cable.kind) break;
            c = next;
        }
        chains.push_back(std::move(chain));
    }
    return chains;
}

}  // namespace

void hang_body(const Scene& scene, Mesh& mesh) {
    const std::vector<RiserChain> chains = chains_of(mesh);
    const auto refuse = [&](std::string problem, std::string why, std::string hint) {
        throw SceneError({scene.file.string(), 0, 0}, "payload.body.size", std::move(problem), std::move(why),
                         std::move(hint));
    };
    const RigidBody body(scene, static_cast<int>(chains.size()));
    const BodyState upright = RigidBody::upright(mesh.axis);
    const Eigen::Matrix3d frame =
        Eigen::Quaterniond(upright.attitude[0], upright.attitude[1], upright.attitude[2], upright.attitude[3])
            .toRotationMatrix();
    const bool packed = scene.parachutes.front().deploy.starts_packed();
    double lift = packed ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < chains.size(); ++k) {
        const Vec3 place = frame * body.places()[k], link = mesh.position[chains[k].nodes.back()];
        const double height = place.dot(mesh.axis), across = (place - link).cross(mesh.axis).norm();
        const double length = packed ? chains[k].rest_length : link.norm();
        if (!(across < length))
            refuse(fmt::format("a riser of {:.4g} m does not reach over the body", length),
                   fmt::format("its place lies {:.4g} m to the side", across), "lengthen the risers");
        // The pack lies on the body; what is drawn out is as high as its risers are long.
        lift = packed ? height
                      : std::min(lift,
                                 height + std::sqrt(length * length - across * across) - link.dot(mesh.axis));
        mesh.places.push_back(place);
    }
    for (NodeIndex i = 0; i < mesh.payload(); ++i)
        mesh.position[i] += lift * mesh.axis;
    for (std::size_t k = 0; k < chains.size(); ++k) {
        const RiserChain& chain = chains[k];
        const NodeIndex end = mesh.first_place() + static_cast<NodeIndex>(k);
        for (NodeIndex& i : mesh.cables[chain.cables.front()].node)
            if (i == mesh.payload()) i = end;
        const Vec3 place = mesh.places[k], link = mesh.position[chain.nodes.back()];
        double length = 0.0;
        for (std::size_t n = 0; n + 1 < chain.nodes.size(); ++n) {
            length += mesh.cables[chain.cables[n]].rest_length;
            mesh.position[chain.nodes[n]] = place + (link - place) * (length / chain.rest_length);
        }
    }
}

}  // namespace twinchute::fullsim
