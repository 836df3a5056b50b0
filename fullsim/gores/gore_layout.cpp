// Gores in lanes: a generated canopy is the same gore over and over, so its elements need neither gathers nor
// scatters.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>
#include "fullsim/forces/canopy_pressure.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/gores/kernels.hpp"
#include "fullsim/layout.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/step/stable_step.hpp"
#include "lib/scene/line_stretch.hpp"

namespace twinchute::fullsim {
namespace {

std::array<double, 3> plain(const Vec3& a) {
    return {a.x(), a.y(), a.z()};
}
Lanes as_lanes(const std::array<double, 3>& a) {
    return Lanes{a[0], a[1], a[2], 0.0};
}

/// Arrays of a frame and the traffic between them and the state's node records.
class GoreNodes {
public:
    /// Of the frame's arrays as many as are named, x first.
    GoreNodes(const Gores& gores, int lanes, int arrays) : gores_(gores) {
        frame.arrays = arrays;
        frame.lanes = lanes;
        frame.blocks = (gores.count + lanes - 1) / lanes;
        frame.nodes = gores.local_nodes();
        frame.own = gores.own;
        frame.canopy = gores.canopy;
        frame.gores = gores.count;
        // A row more at either end: neighbours are read a lane beside their place.
        const std::size_t nodes = frame.at(frame.blocks, 0), row = static_cast<std::size_t>(lanes);
        const std::size_t all = nodes + frame.blocks * row + 2 * row;
        memory_.assign(all / Line{}.size() + 1, Line{});
        double* const begin = memory_.front().data();
        double* next = begin + row;
        // What a triangle reads and writes comes first.
        double** const all_arrays[] = {&frame.x,    &frame.v,      &frame.force,
                                       &frame.push, &frame.v_half, &frame.aero};
        for (int k = 0; k < arrays; ++k, next += 3 * row)
            *all_arrays[k] = next;
        next = begin + row + nodes;
        std::fill_n(next, gores.count, 1.0);
        frame.live = next;
    }

    GoreFrame frame;

    /// A component of a node of a gore.
    double& at(double* array, LocalNode node, int gore, int component) const {
        return array[frame.at(gore / frame.lanes, node) + static_cast<std::size_t>(component) * frame.lanes +
                     gore % frame.lanes];
    }

    void load(const State& state) const {
        const int all = frame.blocks * frame.lanes;
        for (int gore = 0; gore < all; ++gore)
            for (LocalNode n = 0; n < gores_.own; ++n) {
                // A lane without a gore looks like the first one, and stays so.
                const NodeIndex i = gores_.node[(gore < gores_.count ? gore : 0) * gores_.own + n];
                for (int c = 0; c < 3; ++c) {
                    at(frame.x, n, gore, c) = state.node[i].x[c];
                    at(frame.v, n, gore, c) = state.node[i].v[c];
                    at(frame.v_half, n, gore, c) = state.v_half[i].value[c];
                }
            }
        receive_guests(state);
    }

    void store(State& state) const {
        for (int gore = 0; gore < gores_.count; ++gore)
            for (LocalNode n = 0; n < gores_.own; ++n) {
                const NodeIndex i = gores_.node[gore * gores_.own + n];
                for (int c = 0; c < 3; ++c) {
                    state.node[i].x[c] = at(frame.x, n, gore, c);
                    state.node[i].v[c] = at(frame.v, n, gore, c);
                    state.v_half[i].value[c] = at(frame.v_half, n, gore, c);
                }
            }
    }

    void receive_guests(const State& state) const {
        for (std::size_t k = 0; k < gores_.guest.size(); ++k)
            for (int gore = 0; gore < gores_.count; ++gore) {
                const NodeRecord& node = state.node[gores_.guest[k][gore]];
                for (int c = 0; c < 3; ++c) {
                    at(frame.x, first_guest() + static_cast<LocalNode>(k), gore, c) = node.x[c];
                    at(frame.v, first_guest() + static_cast<LocalNode>(k), gore, c) = node.v[c];
                }
            }
    }

    /// What gores did to nodes that they share goes to the state's forces.
    void send_guests(double* array, std::vector<NodeVector>& forces) const {
        for (std::size_t k = 0; k < gores_.guest.size(); ++k) {
            const LocalNode n = first_guest() + static_cast<LocalNode>(k);
            for (int gore = 0; gore < gores_.count; ++gore)
                for (int c = 0; c < 3; ++c)
                    forces[gores_.guest[k][gore]].value[c] += at(array, n, gore, c);
            for (int block = 0; block < frame.blocks; ++block)
                std::fill_n(array + frame.at(block, n), 3 * frame.lanes, 0.0);
        }
    }

private:
    LocalNode first_guest() const { return static_cast<LocalNode>(gores_.own + gores_.neighbour.size()); }

    const Gores& gores_;
    struct alignas(64) Line : std::array<double, 8> {};  // of a cache
    std::vector<Line> memory_;
};

class GoreLayout final : public Layout {
public:
    GoreLayout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants, Gores gores,
               const GoreKernels& kernels)
        : scene_(scene),
          mesh_(mesh),
          constants_(constants),
          kernels_(kernels),
          gores_(std::move(gores)),
          fabric_area_(mesh.fabric_area()),
          tethered_(!mesh.static_line.cables.empty()) {}

    std::string_view name() const override { return "gores in lanes"; }
    std::string_view instruction_set() const override { return kernels_.instruction_set; }

    void begin(State& state, const ForceModels& structure, const ForceModels& loads) override {
        if (tethered_ && mesh_.static_line.cables.empty()) {
            // With the static line goes what gores saw of it.
            gores_ = find_gores(mesh_).value();
            tethered_ = false;
        }
        nodes_ = std::make_unique<GoreNodes>(gores_, kernels_.lanes, 6);
        rows_ = std::make_unique<GoreNodes>(gores_, kernels_.lanes, 1);
        clear_forces(state);
        nodes_->load(state);
        meet_neighbours();
        step_ = {};
        structure_.clear();
        loads_.clear();
        cables_.clear();
        cords_.clear();
        trunk_.clear();
        make_nodes();
        for (const ForceModels* models : {&structure, &loads})
            for (const auto& model : *models) {
                const auto row = std::ranges::find(rows, model->name(), &Row::block);
                if (row == rows.end())
                    throw std::logic_error(fmt::format("no gores in lanes for {}", model->name()));
                (models == &structure ? structure_ : loads_).push_back(row);
                (this->*row->prepare)(*model);
            }
        const auto acts = [&](std::string_view block) {
            return std::ranges::find(structure_, block, &Row::block) != structure_.end() ||
                   std::ranges::find(loads_, block, &Row::block) != loads_.end();
        };
        has_.springs = acts("fabric springs");
        has_.membrane = acts("membrane");
        has_.pressure = acts("canopy pressure");
        has_.folds = acts("fold resistance");
        has_.cloth_drag = acts("cloth drag");
        has_.breathing = acts("breathing damping");
        has_.accretion = acts("accretion");
        has_.mass_damping = acts("mass damping");
        collect_rows_of_cables(state);
    }

    void store(State& state) const override { nodes_->store(state); }

    double membrane_energy(State&) const override { return kernels_.membrane_energy(nodes_->frame, fabric_); }

    void evaluate(State& state, BlockClock& clock) override {
        for (const Row* row : structure_)
            clock.run([&] { (this->*row->add)(state); });
        state.riser_force = to_vec3(state.force[mesh_.payload()].value);
        for (const Row* row : loads_)
            clock.run([&] { (this->*row->add)(state); });
    }

    double stable_step(const State& state) override {
        const GoreFrame &frame = nodes_->frame, &sums = rows_->frame;
        for (int block = 0; block < sums.blocks; ++block)
            for (int n = 0; n < sums.nodes; ++n)
                for (int what = 0; what < 2; ++what)
                    std::fill_n(sums.x + sums.at(block, n) + static_cast<std::ptrdiff_t>(what) * sums.lanes,
                                sums.lanes, rows_of_cables_[n][what]);
        fabric_.weight = state.fe_weight;
        if (has_.membrane) kernels_.membrane_rows(frame, fabric_, triangle_rows_, sums);
        if (has_.springs || has_.folds) kernels_.spring_rows(frame, edges(), sums);
        kernels_.give_back(sums, gores_.neighbour, sums.x);
        const double by_share = (has_.breathing ? breathing(state.air) : 0.0) +
                                (has_.accretion ? std::max(0.0, state.added_mass_rate) : 0.0);
        const double by_mass = has_.mass_damping ? scene_.full.alpha : 0.0;
        find_inverse_inertia(state);
        for (std::size_t n = 0; n < node_.size(); ++n)
            node_damping_[n] = by_share * node_[n].share + by_mass * node_[n].mass;
        return std::min(kernels_.stable_step(sums, inverse_inertia_, node_damping_),
                        stable_step_of_trunk(by_mass));
    }

    void advance(State& state, double dt, double next_added_mass) override {
        const GoreFrame& frame = nodes_->frame;
        nodes_->send_guests(frame.force, state.force);
        nodes_->send_guests(frame.aero, state.aero);
        kernels_.give_back(frame, gores_.neighbour, frame.force);
        if (has_.cloth_drag) kernels_.give_back(frame, gores_.neighbour, frame.aero);  // lines see no image
        if (has_.pressure) kernels_.give_back(frame, gores_.neighbour, frame.push);

        NodeMover mover(state, constants_, dt);
        find_inverse_inertia(state);
        step_.nodes = node_;
        step_.inverse_inertia = inverse_inertia_;
        step_.kick = mover.kick();
        step_.dt = dt;
        // Until snatch the air acts on every triangle; then it does through `push`, and as line drag on the
        // skirt.
        step_.first_aero = has_.cloth_drag ? 0 : gores_.inner;
        step_.gravity = constants_.gravity;
        const GoreSums g = kernels_.advance(frame, step_);

        StepSums sums;
        sums.canopy_position = as_lanes(g.canopy_position);
        sums.canopy_velocity = as_lanes(g.canopy_velocity);
        sums.other_position = as_lanes(g.line_position);
        sums.other_velocity = as_lanes(g.line_velocity);
        sums.area_velocity = as_lanes(g.area_velocity);
        sums.drag_power = Lanes{0.0, 0.0, g.drag_power, 0.0};
        sums.momentum = Lanes{0.0, 0.0, g.momentum, 0.0};
        sums.share_square = g.share_square;
        for (const NodeIndex i : gores_.trunk)
            mover.move_other(i, constants_.mass[i], sums);
        mover.move_static_line(constants_, sums);
        state.damping_power += g.dissipated;
        state.accretion_power += g.accretion_power;
        state.external_power += g.external_power;
        finish_step(state, constants_, sums, mover.kick(), dt, next_added_mass);
        meet_neighbours();
        nodes_->receive_guests(state);
    }

private:
    /// How a block of the registry acts on gores in lanes.
    struct Row {
        std::string_view block;
        void (GoreLayout::*prepare)(const ForceModel&);
        void (GoreLayout::*add)(State&);
    };
    static const std::array<Row, 13> rows;

    struct Has {
        bool springs = false, membrane = false, pressure = false, folds = false, cloth_drag = false;
        bool breathing = false, accretion = false, mass_damping = false;
    };

    const Deployment& deploy() const { return scene_.parachutes.front().deploy; }

    /// Each gore sees the next one's seam where it is now.
    void meet_neighbours() const {
        kernels_.show_neighbours(nodes_->frame, gores_.neighbour, nodes_->frame.x);
        kernels_.show_neighbours(nodes_->frame, gores_.neighbour, nodes_->frame.v);
    }

    void make_nodes() {
        node_.assign(gores_.own, {});
        inverse_inertia_.assign(gores_.own, 0.0);
        for (LocalNode n = 0; n < gores_.own; ++n) {
            const NodeIndex i = gores_.node[n];
            node_[n].mass = constants_.mass[i];
            node_[n].share = constants_.share[i];
        }
    }

    void find_inverse_inertia(const State& state) {
        for (std::size_t n = 0; n < node_.size(); ++n)
            inverse_inertia_[n] = 1.0 / (node_[n].mass + node_[n].share * state.added_mass);
    }

    /// Row sums that do not change: of cables, slack ones too, since they may pull tight any time.
    void collect_rows_of_cables(const State& state) {
        rows_of_cables_.assign(gores_.local_nodes(), {0.0, 0.0});
        node_damping_.assign(gores_.own, 0.0);
        for (const std::vector<CableElement>* cables : {&cables_, &cords_})
            for (const CableElement& c : *cables)
                for (const LocalNode n : c.node) {
                    rows_of_cables_[n][0] += 2.0 * c.stiffness * c.inverse_length;
                    rows_of_cables_[n][1] += 2.0 * c.dashpot;
                }
        trunk_rows_of_cables_ = {std::vector<double>(state.node.size(), 0.0),
                                 std::vector<double>(state.node.size(), 0.0)};
        for (const auto& cables : trunk_)
            cables->add_row_sums(state, trunk_rows_of_cables_);
    }

    /// [s] of the nodes that belong to no gore, whose rows the guests complete.
    double stable_step_of_trunk(double by_mass) const {
        const auto first_guest = static_cast<LocalNode>(gores_.own + gores_.neighbour.size());
        const auto bound = [&](NodeIndex i, double mass, double damping) {
            RowSums row{{trunk_rows_of_cables_.stiffness[i]}, {trunk_rows_of_cables_.damping[i] + damping}};
            for (std::size_t k = 0; k < gores_.guest.size(); ++k)
                for (int gore = 0; gore < gores_.count; ++gore)
                    if (gores_.guest[k][gore] == i) {
                        row.stiffness[0] +=
                            rows_->at(rows_->frame.x, first_guest + static_cast<LocalNode>(k), gore, 0);
                        row.damping[0] +=
                            rows_->at(rows_->frame.x, first_guest + static_cast<LocalNode>(k), gore, 1);
                    }
            return fullsim::stable_step(row, {mass}).dt;
        };
        double least = std::numeric_limits<double>::infinity();
        for (const NodeIndex i : gores_.trunk)
            least = std::min(least, bound(i, constants_.mass[i], by_mass * constants_.mass[i]));
        const auto& line = constants_.static_line_mass;
        const auto first = static_cast<NodeIndex>(constants_.mass.size() + 1);
        for (std::size_t k = 0; k + 1 < line.size(); ++k)  // its far end is not accelerated
            least = std::min(least, bound(first + static_cast<NodeIndex>(k), line[k], 0.0));
        return least;
    }

    void nothing(const ForceModel&) {}

    // --- fabric ---------------------------------------------------------------------------

    void prepare_fabric(const ForceModel&) {
        const MembraneLaw law = membrane_law(mesh_.fabric, scene_.full.bulk_viscosity);
        membrane_.clear();
        triangle_rows_.clear();
        for (const GoreTriangle& t : gores_.triangles) {
            const Triangle flat{{}, t.a, t.b, t.c};
            triangle_rows_.push_back(unstrained_rows(law, flat));
            membrane_.push_back({{t.node[0], t.node[1], t.node[2]},
                                 1.0 / t.a,
                                 1.0 / t.c,
                                 t.b / t.a,
                                 0.5 * t.a * t.c,
                                 law.viscosity * element_length(flat)});
        }
        fabric_ = {membrane_, law, {}, 0.0, 1.0};
    }

    void use_air(const State& state) {
        fabric_.direction = plain(state.air.direction);
        fabric_.radial_pressure = state.air.radial_pressure;
        fabric_.weight = state.fe_weight;
    }
    /// Membranes, and the areas that pressure acts on with them.
    void add_membrane(State& state) {
        use_air(state);
        fabric_sums_ =
            (has_.pressure ? kernels_.membrane_and_pressure : kernels_.membrane)(nodes_->frame, fabric_);
        state.damping_power += fabric_sums_.dissipated;
    }
    void add_pressure(State& state) {
        if (!has_.membrane) {
            use_air(state);
            fabric_sums_ = kernels_.pressure(nodes_->frame, fabric_);
        }
        state.air.projected_area = fabric_sums_.positive_area;
        state.air.signed_area = fabric_sums_.signed_area;
        step_.flag = plain(set_pressure(state.air, smallest_projected_area(scene_.parachutes.front())));
        step_.pressure = state.air.pressure;
    }
    void add_cloth_drag(State& state) {
        state.air.projected_area =
            kernels_
                .cloth_drag(nodes_->frame, fabric_, 0.5 * state.air.density * deploy().drag_coefficient,
                            plain(state.air.wind))
                .positive_area;
    }

    void prepare_springs(const ForceModel&) {
        springs_.clear();
        const double modulus = mesh_.fabric.youngs_modulus;
        const double impedance = scene_.full.bulk_viscosity * std::sqrt(modulus * mesh_.fabric.density);
        for (const GoreEdge& e : gores_.edges)
            springs_.push_back({{e.node[0], e.node[1]},
                                1.0 / e.rest_length,
                                modulus * e.section,
                                spring_growth(e.hardening),
                                (scene_.full.beta * modulus / e.rest_length + impedance) * e.section,
                                deploy().fold_resistance * e.section / mesh_.fabric.thickness});
    }
    SpringPass edges() const {
        return {springs_, deploy().fold_repulsion, has_.springs, has_.folds, full_fold_speed};
    }
    void add_edges(State& state) { state.damping_power += kernels_.springs(nodes_->frame, edges()); }
    /// Springs take the folds along: both need the same lengths.
    void add_folds(State& state) {
        if (!has_.springs) add_edges(state);
    }

    // --- cables ---------------------------------------------------------------------------

    CableElement cable(const GoreCable& c) const {
        const Cable as_indexed{{c.node[0], c.node[1]}, c.rest_length, c.strands, c.kind};
        const CableConstants k =
            cable_constants(mesh_, as_indexed, scene_.full.bulk_viscosity, scene_.full.beta);
        return {{c.node[0], c.node[1]}, 1.0 / c.rest_length, k.stiffness, k.dashpot};
    }
    void prepare_cables(const ForceModel&) {
        cables_.clear();
        for (const GoreCable& c : gores_.cables)
            cables_.push_back(cable(c));
        trunk_.push_back(
            make_cables(mesh_, gores_.trunk_cables, "cable", scene_.full.bulk_viscosity, scene_.full.beta));
        risers_ = trunk_.back().get();
    }
    void add_cables(State& state) {
        state.damping_power += kernels_.cables(nodes_->frame, cables_);
        risers_->add_forces(state);
    }
    void prepare_static_line(const ForceModel&) {
        cords_.clear();
        for (const GoreCable& c : gores_.static_line)
            cords_.push_back(cable(c));
        trunk_.push_back(make_cables(mesh_, gores_.trunk_static_line, "static line",
                                     scene_.full.bulk_viscosity, scene_.full.beta));
        static_line_ = trunk_.back().get();
    }
    void add_static_line(State& state) {
        state.damping_power += kernels_.cables(nodes_->frame, cords_);
        static_line_->add_forces(state);
    }
    void prepare_line_drag(const ForceModel&) {
        lines_.clear();
        for (const GoreCable& c : gores_.cables)
            if (c.kind == CableKind::line) lines_.push_back({c.node[0], c.node[1]});
    }
    void add_line_drag(State& state) {
        if (!(state.air.density > 0.0)) return;  // no Reynolds number without air
        kernels_.line_drag(nodes_->frame, lines_, drag_coefficient_, mesh_.cord(CableKind::line).diameter,
                           state.air.density, state.air.viscosity, plain(state.air.wind));
    }

    // --- loads on nodes, which the step itself adds ---------------------------------------

    void prepare_extraction(const ForceModel&) {
        if (!deploy().extraction_on_apex) {
            for (GoreNode& node : node_)
                node.extraction = node.share;
            return;
        }
        for (LocalNode n = 0; n < gores_.canopy; ++n)
            if (std::ranges::count(mesh_.seam_rings.front(), gores_.node[n]))
                node_[n].extraction = 1.0 / gores_.count;
    }
    void add_extraction(State& state) {
        step_.extraction = plain(deploy().extraction.at(state.time) * trailing_direction(scene_));
    }
    /// [N s/m] of the whole canopy.
    double breathing(const AeroState& air) const {
        return *scene_.aerodynamics.breathing_damping * air.density * air.airspeed * fabric_area_;
    }
    void add_breathing(State& state) {
        step_.breathing = breathing(state.air);
        step_.breathing_mean = plain(state.sums.canopy_area_velocity);
    }
    void add_accretion(State& state) {
        step_.accretion = std::max(0.0, state.added_mass_rate);
        step_.wind = plain(state.air.wind);
    }
    void add_mass_damping(State& state) {
        step_.alpha = scene_.full.alpha;
        step_.mean = plain(state.sums.system_velocity);
        const Lanes mean = to_lanes(state.sums.system_velocity);
        Lanes dissipated = splat(0.0);
        for (const NodeIndex i : gores_.trunk) {
            const Lanes relative = state.node[i].v - mean;
            const Lanes resistance = step_.alpha * constants_.mass[i] * relative;
            state.force[i].value -= resistance;
            dissipated += resistance * relative;
        }
        state.damping_power += sum3(dissipated);
    }
    void prepare_payload_drag(const ForceModel& block) { payload_drag_ = &block; }
    void add_payload_drag(State& state) { payload_drag_->add_forces(state); }

    const Scene& scene_;
    const Mesh& mesh_;
    const NodeConstants& constants_;
    const GoreKernels& kernels_;
    Gores gores_;
    std::unique_ptr<GoreNodes> nodes_, rows_;  // all arrays, and row sums
    double fabric_area_;                       // [m^2]
    bool tethered_;                            // to a static line
    std::vector<const Row*> structure_, loads_;
    Has has_;

    std::vector<MembraneElement> membrane_;
    MembranePass fabric_;
    FabricSums fabric_sums_;
    std::vector<SpringElement> springs_;
    std::vector<CableElement> cables_, cords_;
    std::vector<Node2> lines_;
    CylinderDragTable drag_coefficient_;
    std::vector<GoreNode> node_;
    std::vector<double> inverse_inertia_, node_damping_;
    std::vector<std::array<double, 2>> rows_of_cables_;  // of each local node: stiffness, damping
    RowSums trunk_rows_of_cables_;
    std::vector<TriangleRows> triangle_rows_;
    GoreAdvance step_;
    ForceModels trunk_;  // cables that belong to no gore
    const ForceModel *risers_ = nullptr, *static_line_ = nullptr, *payload_drag_ = nullptr;
};

const std::array<GoreLayout::Row, 13> GoreLayout::rows{{
    {"membrane", &GoreLayout::prepare_fabric, &GoreLayout::add_membrane},
    {"fabric springs", &GoreLayout::prepare_springs, &GoreLayout::add_edges},
    {"cable", &GoreLayout::prepare_cables, &GoreLayout::add_cables},
    {"static line", &GoreLayout::prepare_static_line, &GoreLayout::add_static_line},
    {"canopy pressure", &GoreLayout::prepare_fabric, &GoreLayout::add_pressure},
    {"cloth drag", &GoreLayout::prepare_fabric, &GoreLayout::add_cloth_drag},
    {"fold resistance", &GoreLayout::prepare_springs, &GoreLayout::add_folds},
    {"extraction", &GoreLayout::prepare_extraction, &GoreLayout::add_extraction},
    {"line drag", &GoreLayout::prepare_line_drag, &GoreLayout::add_line_drag},
    {"breathing damping", &GoreLayout::nothing, &GoreLayout::add_breathing},
    {"payload drag", &GoreLayout::prepare_payload_drag, &GoreLayout::add_payload_drag},
    {"accretion", &GoreLayout::nothing, &GoreLayout::add_accretion},
    {"mass damping", &GoreLayout::nothing, &GoreLayout::add_mass_damping},
}};

}  // namespace

std::unique_ptr<Layout> make_gore_layout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants,
                                         const GoreKernels* kernels) {
    auto gores = find_gores(mesh);
    if (!gores) return nullptr;
    return std::make_unique<GoreLayout>(scene, mesh, constants, std::move(*gores),
                                        kernels ? *kernels : gore_kernels());
}

}  // namespace twinchute::fullsim
