#include "fullsim/time/mass_scaling.hpp"

#include <algorithm>
#include <limits>

#include "fullsim/forces/registry.hpp"
#include "fullsim/time/central_difference.hpp"
#include "fullsim/time/critical_step.hpp"

namespace twinchute::fullsim {
namespace {

/// Tangent of one stage at the nodes, unstrained, and the largest step with the masses as they are.
struct Hold {
    GershgorinSums sums;
    double dt = 0.0;  // [s]
};

Hold hold_of(const Scene& scene, const Mesh& mesh, Stage stage) {
    State still;  // nothing is strained
    still.stage = stage;
    still.fe_weight = 1.0;
    still.node.assign(
        static_cast<std::size_t>(mesh.first_static_line_node()) + mesh.static_line.position.size(),
        {splat(0.0), splat(0.0)});
    const NodeConstants constants = node_constants(mesh, 0.0);
    const ForceModels structure = make_structure(scene, mesh, stage);
    const ForceModel* lines = find_block(structure, Block::lines);
    const ForceModel* apart = stage == Stage::flight && scene.full.line_substeps > 1 ? lines : nullptr;
    PerronScaling weights;
    weights.begin(still, constants, structure, lines);
    Hold hold{no_rows(still, weights.by_node())};
    for (const auto& model : structure)
        if (model.get() != apart) model->add_row_sums(still, hold.sums);
    std::vector<double> mass = mesh.mass;
    std::fill(mass.begin() + mesh.canopy_nodes, mass.end(), std::numeric_limits<double>::infinity());
    hold.dt = critical_step(hold.sums, mass).dt;
    return hold;
}

}  // namespace

MassScaling scale_masses(const Scene& scene, double share, double air, Mesh& mesh) {
    std::vector<Hold> holds{hold_of(scene, mesh, Stage::flight)};
    if (scene.parachutes.front().deploy.starts_packed())
        holds.push_back(hold_of(scene, mesh, Stage::deployment));

    // The mass with which a node's row allows the step (critical_step.hpp): K dt^2/4 + C dt.
    const auto missing = [&](NodeIndex i, double longer) {
        double mass = mesh.mass[i];
        for (const Hold& hold : holds) {
            const double dt = longer * hold.dt;
            mass = std::max(mass, dt * (0.25 * dt * hold.sums.stiffness[i] + hold.sums.damping[i]));
        }
        return mass - mesh.mass[i];
    };
    const auto sum_missing = [&](double longer) {
        double sum = 0.0;
        for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
            sum += missing(i, longer);
        return sum;
    };
    double canopy = air;
    for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i)
        canopy += mesh.mass[i];
    const double budget = share * canopy;

    double low = 1.0, high = 2.0;
    while (sum_missing(high) < budget)
        high *= 2.0;
    for (int k = 0; k < 60; ++k) {  // to the last bits
        const double middle = 0.5 * (low + high);
        (sum_missing(middle) <= budget ? low : high) = middle;
    }
    MassScaling done{0.0, 0.0, 0, low};
    for (NodeIndex i = 0; i < mesh.canopy_nodes; ++i) {
        const double more = missing(i, low);
        done.nodes += more > 0.0;
        done.mass += more;
        mesh.mass[i] += more;
    }
    done.share = done.mass / canopy;
    return done;
}

}  // namespace twinchute::fullsim
