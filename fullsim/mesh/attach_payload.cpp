#include "fullsim/mesh/attach_payload.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fullsim/attitude.hpp"
#include "lib/scene/needs.hpp"
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

/// Angle around the axis, from the frame's x toward its y, of where the lines above each chain lead [rad].
std::vector<double> azimuths_of(const Mesh& mesh, const std::vector<RiserChain>& chains,
                                const Eigen::Matrix3d& frame) {
    std::vector<std::vector<NodeIndex>> above(mesh.position.size());
    for (const Cable& c : mesh.cables)
        if (!is_tape(c.kind))
            for (const int end : {0, 1})
                above[c.node[end]].push_back(c.node[1 - end]);
    std::vector<double> azimuths;
    for (const RiserChain& chain : chains) {
        std::vector<NodeIndex> open{chain.nodes.back()};
        std::vector<bool> seen(mesh.position.size(), false);
        seen[mesh.payload()] = true;
        for (const NodeIndex i : chain.nodes)
            seen[i] = true;
        Vec3 sum = Vec3::Zero();
        while (!open.empty()) {
            const NodeIndex here = open.back();
            open.pop_back();
            if (mesh.is_canopy(here)) {
                Vec3 across = frame.transpose() * mesh.position[here];
                across.z() = 0.0;
                sum += across.normalized();
                continue;
            }
            for (const NodeIndex next : above[here])
                if (!seen[next]) {
                    seen[next] = true;
                    open.push_back(next);
                }
        }
        azimuths.push_back(std::atan2(sum.y(), sum.x()));
    }
    return azimuths;
}

/// Indices in the order of the angles.
std::vector<std::size_t> order_of(const std::vector<double>& angles) {
    std::vector<std::size_t> order(angles.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return angles[i]; });
    return order;
}

/// The place of each chain: around the axis in the same order, turned so that they are nearest.
std::vector<std::size_t> matched(const std::vector<double>& chains, const std::vector<double>& attachments) {
    const std::vector<std::size_t> chain = order_of(chains), place = order_of(attachments);
    const std::size_t count = chain.size();
    std::size_t best = 0;
    double nearest = -std::numeric_limits<double>::infinity();
    for (std::size_t shift = 0; shift < count; ++shift) {
        double near = 0.0;
        for (std::size_t k = 0; k < count; ++k)
            near += std::cos(chains[chain[k]] - attachments[place[(k + shift) % count]]);
        if (near > nearest + 1e-9) nearest = near, best = shift;
    }
    std::vector<std::size_t> of(count);
    for (std::size_t k = 0; k < count; ++k)
        of[chain[k]] = place[(k + best) % count];
    return of;
}

/// Attachment points of a scene's shape, about its centre [m].
std::vector<Vec3> attachments_on(const Scene& scene, std::size_t risers) {
    const PayloadBody& body = *scene.payload.body;
    const bool box = body.shape == PayloadBody::Shape::box;
    const double top = 0.5 * body.size.back();
    if (body.sling_length) {
        if (risers != 1)  // of a mesh of one's own
            throw SceneError({scene.file.string(), 0, 0}, "payload.body.sling_length",
                             fmt::format("{} risers on slings", risers), "slings meet at one point",
                             "tie the mesh to one node, or leave sling_length out");
        return {{0.0, 0.0, top + sling_geometry(body).rise}};
    }
    if (risers == 1) return {{0.0, 0.0, top}};
    if (box && risers != 4)
        throw SceneError({scene.file.string(), 0, 0}, "payload.body.shape",
                         fmt::format("a box on {} risers", risers),
                         "it has four upper corners, or one middle",
                         "write parachute.risers = 4 or 1, or shape = \"cylinder\"");
    std::vector<Vec3> attachments;
    for (std::size_t r = 0; r < risers; ++r) {
        // Each riser's lines lie around this direction.
        const double angle = 2.0 * pi * (static_cast<double>(r) + 0.5) / static_cast<double>(risers);
        const double x = std::cos(angle), y = std::sin(angle);
        attachments.push_back(
            box ? Vec3(std::copysign(0.5 * body.size[0], x), std::copysign(0.5 * body.size[1], y), top)
                : Vec3(0.5 * body.size[0] * x, 0.5 * body.size[0] * y, top));
    }
    return attachments;
}

int node_at(const SolidMesh& solid, const Vec3& place) {
    const auto nearest =
        std::ranges::min_element(solid.node, {}, [&](const Vec3& x) { return (x - place).squaredNorm(); });
    return static_cast<int>(nearest - solid.node.begin());
}

/// Body that the scene describes, on risers in the order of the mesh.
BodyMesh body_of_scene(const Scene& scene, const Mesh& mesh, const std::vector<RiserChain>& chains,
                       const Eigen::Matrix3d& frame) {
    const PayloadBody& shape = *scene.payload.body;
    const std::vector<Vec3> attachments = attachments_on(scene, chains.size());
    const int risers = static_cast<int>(chains.size());
    BodyMesh body;
    body.deformable = shape.elasticity.has_value();
    const SolidMesh fine = make_solid(shape, risers);
    body.lumped = lump(solid_of(fine), scene.payload.mass);
    body.solid = body.deformable ? make_coarse_solid(shape, risers) : fine;
    std::vector<double> at;
    for (const Vec3& place : attachments)
        at.push_back(std::atan2(place.y(), place.x()));
    if (shape.sling_length) body.solid.node.push_back(attachments.front());  // of no tetrahedron
    for (const std::size_t k : matched(azimuths_of(mesh, chains, frame), at))
        body.end.push_back(node_at(body.solid, attachments[k]));
    return body;
}

}  // namespace

Eigen::Matrix3d frame_along(const Vec3& axis) {
    Eigen::Matrix3d frame;
    frame.col(0) = axis.unitOrthogonal();
    frame.col(1) = axis.cross(frame.col(0));
    frame.col(2) = axis;
    return frame;
}

Eigen::Matrix3d frame_at_start(const Release& release, const Vec3& axis) {
    if (!release.attitude) return frame_along(axis);
    return turn_of(*release.attitude).toRotationMatrix();
}

void attach_payload(const Scene& scene, Mesh& mesh, Hang hang) {
    const std::vector<RiserChain> chains = chains_of(mesh);
    const Eigen::Matrix3d frame = hang == Hang::as_made ? Eigen::Matrix3d(Eigen::Matrix3d::Identity())
                                                        : frame_at_start(scene.release, mesh.axis);
    if (!mesh.body) mesh.body = body_of_scene(scene, mesh, chains, frame);
    const BodyMesh& body = *mesh.body;
    for (const Vec3& place : body.attachments())
        mesh.attachments.push_back(frame * place);
    const auto end_of = [&](std::size_t k) { return static_cast<std::size_t>(body.place_of(k)); };
    Vec3 beside = Vec3::Zero();
    if (body.middle) {
        // As the file has it: its centre may lie beside the axis of the parachute.
        beside = frame * Vec3(body.middle->x(), body.middle->y(), 0.0);
    } else if (scene.release.attitude) {
        const Vec3 middle = std::accumulate(mesh.attachments.begin(), mesh.attachments.end(), beside) /
                            static_cast<double>(mesh.attachments.size());
        beside = middle - middle.dot(mesh.axis) * mesh.axis;
    }
    for (NodeIndex i = 0; i < mesh.payload(); ++i)
        mesh.position[i] += beside;
    const bool packed = hang == Hang::packed;
    double lift = packed ? 0.0 : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < chains.size(); ++k) {
        const Vec3 place = mesh.attachments[end_of(k)], link = mesh.position[chains[k].nodes.back()];
        const double height = place.dot(mesh.axis), across = (place - link).cross(mesh.axis).norm();
        const double length = chains[k].rest_length * (packed ? 1.0 : mesh.line_stretch);
        if (!(across < length))
            throw SceneError({scene.file.string(), 0, 0},
                             scene.payload.body->size.empty() ? "payload.body.shape" : "payload.body.size",
                             fmt::format("a riser of {:.4g} m does not reach over the body", length),
                             fmt::format("its place lies {:.4g} m to the side", across),
                             "lengthen the risers");
        // The pack lies on the body; what is drawn out is as high as its risers are long.
        lift = packed ? std::max(lift, height)
                      : std::min(lift,
                                 height + std::sqrt(length * length - across * across) - link.dot(mesh.axis));
    }
    for (NodeIndex i = 0; i < mesh.payload(); ++i)
        mesh.position[i] += lift * mesh.axis;
    for (std::size_t k = 0; k < chains.size(); ++k) {
        const RiserChain& chain = chains[k];
        const NodeIndex end = mesh.first_attachment() + body.place_of(k);
        for (NodeIndex& i : mesh.cables[chain.cables.front()].node)
            if (i == mesh.payload()) i = end;
        const Vec3 place = mesh.attachments[end_of(k)], link = mesh.position[chain.nodes.back()];
        double length = 0.0;
        for (std::size_t n = 0; n + 1 < chain.nodes.size(); ++n) {
            length += mesh.cables[chain.cables[n]].rest_length;
            mesh.position[chain.nodes[n]] = place + (link - place) * (length / chain.rest_length);
        }
    }
}

}  // namespace twinchute::fullsim
