// The gore-batched layout: a generated canopy is the same gore over and over, so its elements need neither
// gathers nor scatters.
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <unordered_map>

#include <fmt/format.h>

#include "fullsim/forces/canopy_pressure.hpp"
#include "fullsim/forces/gore_contact.hpp"
#include "fullsim/forces/inflow.hpp"
#include "fullsim/forces/node_loads.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/storage/gore_batched/gore_bound.hpp"
#include "fullsim/storage/gore_batched/gore_elements.hpp"
#include "fullsim/storage/gore_batched/gore_nodes.hpp"
#include "fullsim/storage/gore_batched/gore_self_contact.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"
#include "fullsim/storage/layout.hpp"
#include "fullsim/threads/thread_count_tuner.hpp"
#include "fullsim/threads/worker_pool.hpp"
#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/energy.hpp"
#include "fullsim/time/node_mover.hpp"
#include "fullsim/time/subcycling.hpp"
#include "lib/scene/line_stretch.hpp"

namespace twinchute::fullsim {
namespace {

std::array<double, 3> to_array(const Vec3& a) {
    return {a.x(), a.y(), a.z()};
}
Lanes as_lanes(const std::array<double, 3>& a) {
    return Lanes{a[0], a[1], a[2], 0.0};
}

constexpr std::size_t elements_of_thread = 1500;

class GoreLayout final : public Layout {
public:
    GoreLayout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants, Gores gores,
               const GoreKernels& kernels, int threads)
        : scene_(scene),
          mesh_(mesh),
          constants_(constants),
          kernels_(kernels),
          tuner_(threads),
          gores_(std::move(gores)),
          inflow_(InflowBalance::of(scene, mesh)),
          tethered_(!mesh.static_line.cables.empty()) {
        if (threads > 1) threads_ = std::make_unique<WorkerPool>(threads - 1);
        if (inflow_) find_edges();
    }

    std::string_view name() const override { return "gore-batched"; }
    std::string_view instruction_set() const override { return kernels_.instruction_set; }
    int threads() const override { return tuner_.most(); }

    void begin(State& state, const ForceModels& structure, const ForceModels& loads,
               const Body* body) override {
        body_ = body;
        if (tethered_ && mesh_.static_line.cables.empty()) {
            // With the static line goes what gores saw of it.
            gores_ = find_gores(mesh_).value();
            tethered_ = false;
        }
        const auto acts = [&](Block block) {
            return find_block(structure, block) || find_block(loads, block);
        };
        has_ = {};
        models_ = {&structure, &loads};
        const auto acts_by_itself = [this](const auto& model) {
            return !row_of(model->block()) && !model->node_load();
        };
        has_.own_loops =
            std::ranges::any_of(structure, acts_by_itself) || std::ranges::any_of(loads, acts_by_itself);
        has_.air_on_fabric = acts(Block::fabric_drag) || has_.own_loops;
        nodes_ = std::make_unique<GoreNodes>(gores_, kernels_.lanes,
                                             what_air_does(acts(Block::canopy_pressure), has_.air_on_fabric));
        self_contact_.reset();
        clear_forces(state, has_.own_loops || acts(Block::self_contact) ? 0 : first_held());
        nodes_->load(state);
        step_ = {};
        inertia_with_ = -1.0;
        line_damping_ = 0.0;
        lines_row_ = nullptr;
        structure_.clear();
        loads_.clear();
        elements_ = {};
        make_nodes();
        sums_.assign(nodes_->frame.blocks, {});
        for (const ForceModels* models : {&structure, &loads})
            for (const auto& model : *models) {
                const Row* row = row_of(model->block());
                (models == &structure ? structure_ : loads_)
                    .push_back({row, model.get(), model->node_load()});
                if (row) (this->*row->prepare)(*model);
            }
        has_.springs = acts(Block::fabric_springs);
        has_.membrane = acts(Block::membrane);
        has_.pressure = acts(Block::canopy_pressure);
        air_ = !has_.pressure ? AirOnFabric::none : inflow_ ? AirOnFabric::fills : AirOnFabric::pushes;
        has_.folds = acts(Block::deployment_resistance);
        exchanged_ = {nodes_->frame.force};
        if (has_.air_on_fabric) exchanged_.push_back(nodes_->frame.aero);  // lines see no halo node
        if (has_.pressure) exchanged_.push_back(nodes_->frame.push);
        elements_.membranes_act = has_.membrane;
        elements_.springs_act = has_.springs || has_.folds;
        bound_ = std::make_unique<GoreBound>(constants_, gores_, kernels_, elements_, node_);
        bound_->begin(state, structure, node_loads_at(state).mass_damping);
    }

    void store(State& state) const override { nodes_->store(state); }

    std::vector<PlanArray> arrays() const override {
        std::vector<PlanArray> all;
        add_bytes(all, "nodes of gores", nodes_->bytes() + bound_->bytes_of_nodes() + bytes_of(node_));
        // Canopy pressure, fabric drag and membranes read the same constants of triangles.
        add_bytes(all, "triangles", bytes_of(elements_.membrane) + bound_->bytes_of_triangles());
        // Springs and deployment resistance those of edges.
        add_bytes(all, "edges", bytes_of(elements_.springs) + bound_->bytes_of_springs());
        add_bytes(all, "tapes", bytes_of(elements_.tapes));
        add_bytes(all, "lines", bytes_of(elements_.lines));
        add_bytes(all, "static line", bytes_of(elements_.cords));
        add_bytes(all, "gore contact", bytes_of(elements_.contacts));
        if (self_contact_) add_bytes(all, "nodes in self-contact", self_contact_->bytes());
        return all;
    }

    double membrane_energy(State& state) const override {
        return kernels_.membrane_levels(nodes_->up_to_date(state), elements_.membrane, fabric_).energy;
    }

    EnergiesAndStrains levels(const State& state) const override {
        if (has_.own_loops) return levels_of(stored(state), constants_, *models_.front());
        EnergiesAndStrains levels{kernels_.kinetic_energy(nodes_->frame, node_, state.added_mass), 0.0, {}};
        for (const NodeIndex i : gores_.global)
            levels.kinetic += 0.5 * constants_.mass[i] * sum3(state.node[i].v * state.node[i].v);
        levels.kinetic += static_line_kinetic_energy(state, constants_);
        for (const Acting& block : structure_) {
            const EnergyAndStrain of_row = (this->*block.row->levels)(state);
            levels.elastic += of_row.energy;
            levels.strain.push_back(of_row.strain);
        }
        return levels;
    }

    double fabric_strain(const State& state) const override {
        double longest = -1.0;
        for (const Acting& block : structure_)
            if (is_folding_fabric(block.model->block()))
                longest = std::max(longest, (this->*block.row->levels)(state).strain);
        return longest;
    }

    void evaluate(State& state, BlockClock& clock) override {
        tuner_.begin_step();
        use_air(state);
        node_loads_ = {};
        step_.contact_reaction = {};
        const auto work = [this](const Row* row, const GoreFrame& part) {
            ElementSums& sums = sums_[part.first].of_row[row - rows.data()];
            sums = row->work ? (this->*row->work)(part) : ElementSums{};
        };
        // For the clock, one block of forces after the other; otherwise each thread does all of them for the
        // gores that it has. Nothing but the order differs, and no force sees that.
        const bool at_once = tuner_.now() > 1 && !clock.timed();
        if (at_once)
            for_parts([&](const GoreFrame& part) {
                nodes_->gather_halo(part.first);
                nodes_->gather_shared(state, part.first);
                for (const auto* blocks : {&structure_, &loads_})
                    for (const Acting& block : *blocks)
                        if (block.row) work(block.row, part);
                reduce_block(part.first);
            });
        else
            nodes_->up_to_date(state);
        const auto run = [&](const std::vector<Acting>& blocks) {
            for (const Acting& block : blocks)
                clock.run([&] {
                    const auto* const row = block.row;
                    if (block.load) return block.load->add_to(node_loads_, state);
                    if (!row) return block.model->add_forces(state);
                    if (!at_once && row->work) for_parts([&](const GoreFrame& part) { work(row, part); });
                    ElementSums total;
                    if (row->work)
                        for (const SumsOfBlock& of_part : sums_)
                            total += of_part.of_row[row - rows.data()];
                    (this->*row->finish)(state, total);
                });
        };
        if (has_.own_loops) nodes_->store(state);
        run(structure_);
        note_riser_force(state, mesh_.payload());
        run(loads_);
        damp_global(state);
        if (has_.own_loops) nodes_->scatter_add_forces(state);
        if (!at_once) for_parts([&](const GoreFrame& part) { reduce_block(part.first); });
    }

    CriticalSteps critical_steps(const State& state) override {
        if (has_.own_loops) {
            const double all =
                critical_step(stored(state), constants_, *models_[0], *models_[1], bound_->weights(state)).dt;
            return {all, all, all};  // without subcycles
        }
        const NodeLoads loads = node_loads_at(state);
        bound_->renew(state, loads.mass_damping);
        fabric_.weight = state.fe_weight;
        for_parts([&](const GoreFrame& part) {
            nodes_->gather_halo(part.first);
            bound_->add_rows(part, fabric_, edges());
        });
        if (self_contact_) {
            GershgorinSums of_contact = no_rows(state, bound_->weights(state));
            self_contact_->add_row_sums(state, of_contact);
            bound_->add_contact(of_contact, node_loads_at(state).mass_damping);
        }
        find_inverse_inertia(state);
        return bound_->steps(inverse_inertia_, loads);
    }

    void read(const State&, std::span<const NodeIndex> nodes, std::span<NodeRecord> to) const override {
        nodes_->read(nodes, to);
    }
    void push(State&, std::span<const NodeIndex> nodes, std::span<const Lanes> force) const override {
        nodes_->push(nodes, force);
    }
    void accelerate(const Vec3& acceleration) override {
        step_.has_contact_reaction = true;
        for (std::size_t c = 0; c < 3; ++c)
            step_.contact_reaction[c] += acceleration[static_cast<int>(c)];
    }
    void impulse(State& state) override {
        if (together()) {
            state.damping_power += line_damping_;
            nodes_->scatter_add_shared(0, state.force);
        }
        nodes_->scatter_add_shared(1, state.aero);
        NodeMover mover(state, constants_, dt_);
        find_inverse_inertia(state);
        step_.nodes = node_;
        step_.inverse_inertia = inverse_inertia_;
        step_.kick = mover.kick();
        step_.dt = dt_;
        // Until snatch the air acts on every triangle; then it does through `push`, and as line drag on the
        // skirt.
        step_.first_aero = has_.air_on_fabric ? 0 : gores_.inner;
        step_.first_pulled = gores_.inner;
        step_.together = together();
        const GoreSubcycle first = subcycle_of(state, 0);
        step_.first_kick = first.step.kick;
        step_.weighs = state.energy.weighs;
        step_.last_dt = state.dt;
        step_.last_line_dt = state.line_dt;
        step_.gravity = constants_.gravity;
        step_.halo = nodes_->halo();
        step_.pushed = has_.pressure;
        step_.on_fabric = to_array(node_loads_.on_fabric);
        step_.loads_fabric = !node_loads_.on_fabric.isZero(0.0);
        step_.breathing = node_loads_.breathing;
        step_.canopy_mean = to_array(node_loads_.canopy_mean);
        step_.accretion = node_loads_.accretion;
        step_.wind = to_array(node_loads_.wind);
        step_.mass_damping = node_loads_.mass_damping;
        step_.system_mean = to_array(node_loads_.system_mean);
        step_.halo_aero = has_.air_on_fabric;
        StepSums sums = step_sums_;
        if (self_contact_) take_out_contact(sums);
        for_parts([&](const GoreFrame& part) {
            nodes_->receive_halo_forces(part.first, exchanged_);
            sums_[part.first].step = kernels_.advance(part, step_);
            if (together())
                nodes_->send_first_gore(part.first);
            else
                kernels_.subcycle(part, first);  // of gores alone: it asks for no forces
        });

        for (const auto& [of_row, g] : sums_) {
            add_positions(g, sums);
            sums.drag_power[2] += g.drag_power;
            sums.momentum[2] += g.momentum;
            sums.share_square += g.share_square;
            sums.kinetic += g.kinetic;
            state.damping_power += g.dissipated;
            state.accretion_power += g.accretion_power;
            state.external_power += g.external_power;
        }
        if (together()) {
            mover.move_others(gores_.global, constants_, sums);
            if (body_) body_->advance(state, mover.kick(), dt_);
        } else {
            for (std::size_t k = 0; k < gores_.global.size(); ++k) {
                const NodeIndex i = gores_.global[k];
                mover.kick_alone(i, global_nodes_.others(k), constants_.mass[i], constants_.mass[i],
                                 step_.first_kick, sums);
            }
            if (body_) body_->impulse(state, mover.kick());
        }
        mover.move_static_line(constants_, sums);
        step_sums_ = sums;
    }
    // Skirt, lines, links, risers and payload in subcycles; in the first, which gores have taken with the
    // impulse, the others alone.
    void pull(State& state, int k) override {
        const bool last = k + 1 == subcycles_;
        const GoreSubcycle move = subcycle_of(state, k);
        for_parts([&](const GoreFrame& part) {
            nodes_->gather_shared(state, part.first);
            sums_[part.first].step = kernels_.subcycle(part, move);
            nodes_->reduce_shared(part.first, {&nodes_->frame.force, 1});
            if (last) nodes_->send_first_gore(part.first);
        });
        double dissipated = 0.0;
        for (const SumsOfBlock& of_part : sums_) {
            dissipated += of_part.step.dissipated;
            state.largest.add_tension(of_part.step.largest_tension);
        }
        stretch_risers(state, dissipated);
        state.in_subcycles.add(state.force[mesh_.payload()].value);
        nodes_->scatter_add_shared(0, state.force);
    }
    void drift(State& state, int k) override {
        const Subcycle step = subcycle(state, dt_, subcycles_, k);
        step_sums_.line_damping += step.kick * line_damping_;
        NodeMover mover(state, constants_, dt_);
        for (const NodeIndex i : gores_.global)
            mover.move_in_subcycle(i, constants_.mass[i], step);
        if (body_) body_->move(state, step.kick, step.dt);
    }
    void end_step(State& state, double next_added_mass) override {
        NodeMover mover(state, constants_, dt_);
        if (!together()) {
            for (const SumsOfBlock& of_part : sums_)
                add_positions(of_part.step, step_sums_);
            step_sums_.line_damping_power = line_damping_ / subcycles_;
            for (const NodeIndex i : gores_.global) {
                mover.end_subcycles(i);
                mover.add_other(i, constants_.mass[i], step_sums_);
            }
            if (body_) body_->finish(state, dt_);
        }
        finish_step(state, constants_, step_sums_, mover.kick(), dt_, dt_ / subcycles_, next_added_mass);
    }

    void serialize(Archive& archive, const State& state) override {
        nodes_->serialize(archive);
        bound_->serialize(archive, state, node_loads_at(state).mass_damping);
    }

private:
    void separate(State& state) override {
        global_nodes_.take_others(state);  // nothing but lines acts on links by way of gores
        nodes_->scatter_add_shared(0, state.force);
    }

    /// How a block of the registry acts on batches of gores.
    struct Row {
        Block block;
        void (GoreLayout::*prepare)(const ForceModel&);
        ElementSums (GoreLayout::*work)(const GoreFrame&) const;  // on some gores; null: nothing
        /// With the sums of all gores: what is left to do, once.
        void (GoreLayout::*finish)(State&, const ElementSums&);
        EnergyAndStrain (GoreLayout::*levels)(const State&) const = nullptr;  // of structure
    };
    static const std::array<Row, 14> rows;
    const Row* row_of(Block block) const {
        // Tetrahedra act on nodes of the state, where there is a body at all.
        if (block == Block::payload_tetrahedra && mesh_.attachments.empty()) return nullptr;
        const auto row = std::ranges::find(rows, block, &Row::block);
        return row == rows.end() ? nullptr : &*row;
    }
    /// A block of the stage. Without a row, and if it is no load on nodes, it acts by its own loop on the
    /// records of the state: slower, and right.
    struct Acting {
        const Row* row;
        const ForceModel* model;
        const NodeLoad* load;
    };

    /// On lines of its own, since another thread writes those of the next block.
    struct alignas(128) SumsOfBlock {
        std::array<ElementSums, 14> of_row{};  // of the last pass of each row of the table
        GoreSums step;
    };

    struct Has {
        bool springs = false, membrane = false, pressure = false, folds = false, air_on_fabric = false;
        bool own_loops = false;  // of blocks without a row here
        bool line_drag = false;
    };

    const Deployment& deploy() const { return scene_.parachutes.front().deploy; }

    /// Blocks of gores, one after the other or several at once. Sums are those of a block, added in the
    /// blocks' order: they do not know of threads.
    template <class Work>
    void for_parts(Work&& work) const {
        const int blocks = nodes_->frame.blocks;
        const auto do_part = [&](int block) {
            GoreFrame part = nodes_->frame;
            part.first = block;
            part.last = block + 1;
            work(part);
        };
        if (tuner_.now() > 1)
            threads_->share(blocks, do_part);
        else
            for (int block = 0; block < blocks; ++block)
                do_part(block);
    }

    State stored(const State& state) const {
        State all = state;
        nodes_->store(all);
        return all;
    }

    /// Writes the forces of a block's gores on nodes of others into the exchange buffers.
    void reduce_block(int block) const {
        nodes_->send_halo_forces(block, exchanged_);
        nodes_->reduce_shared(block, std::array{nodes_->frame.force, nodes_->frame.aero});
    }

    static GoreNodes::What what_air_does(bool pressure, bool on_fabric) {
        using enum GoreNodes::What;
        return !on_fabric ? pushed : pressure ? pushed_and_dragged : dragged;
    }

    /// The first node whose forces are the state's: of global structure and shared nodes, which nodes of
    /// gores come before.
    std::size_t first_held() const {
        NodeIndex first = gores_.global.front();
        for (const auto& of_gores : gores_.shared)
            first = std::min(first, std::ranges::min(of_gores));
        return static_cast<std::size_t>(first);
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
        if (state.added_mass == inertia_with_) return;
        inertia_with_ = state.added_mass;
        for (std::size_t n = 0; n < node_.size(); ++n)
            inverse_inertia_[n] = 1.0 / (node_[n].mass + node_[n].share * state.added_mass);
    }

    static void add_positions(const GoreSums& g, StepSums& sums) {
        sums.canopy_position += as_lanes(g.canopy_position);
        sums.canopy_velocity += as_lanes(g.canopy_velocity);
        sums.other_position += as_lanes(g.line_position);
        sums.other_velocity += as_lanes(g.line_velocity);
        sums.area_velocity += as_lanes(g.area_velocity);
    }

    GoreSubcycle subcycle_of(const State& state, int k) const {
        return {node_,
                inverse_inertia_,
                elements_.lines,
                k == 0,
                nodes_->halo()[gores_.inner],
                subcycle(state, dt_, subcycles_, k),
                k + 1 == subcycles_ ? 0.5 * dt_ : 0.0};
    }

    // --- fabric ---------------------------------------------------------------------------

    void book(State& state, const ElementSums& all) { state.damping_power += all.dissipated; }

    NodeLoads node_loads_at(const State& state) const {
        NodeLoads loads;
        for (const Acting& block : loads_)
            if (block.load) block.load->add_to(loads, state);
        return loads;
    }

    void prepare_fabric(const ForceModel&) {
        elements_.law = membrane_law(mesh_.fabric, scene_.full.bulk_viscosity);
        elements_.membrane = gore_membranes(gores_, elements_.law);
        fabric_ = {elements_.law};
    }

    void use_air(const State& state) {
        fabric_.direction = to_array(state.air.direction);
        fabric_.radial_pressure = state.air.radial_pressure;
        fabric_.weight = state.fe_weight;
        wind_ = to_array(state.air.wind);
        if (!elements_.contacts.empty()) axis_ = axis(state);
        density_ = state.air.density;
        viscosity_ = state.air.viscosity;
    }
    EnergyAndStrain fabric_levels(const State& state) const {
        // Fabric that is held by springs still carries its share only.
        EnergyAndStrain levels =
            kernels_.membrane_levels(nodes_->up_to_date(state), elements_.membrane, fabric_);
        levels.energy *= state.fe_weight;
        levels.strain *= state.fe_weight;
        return levels;
    }
    /// Membranes, and the areas that pressure acts on with them.
    ElementSums stretch_membrane(const GoreFrame& part) const {
        return kernels_.membrane[static_cast<int>(air_)](part, elements_.membrane, fabric_);
    }
    void finish_membrane(State& state, const ElementSums& all) {
        fabric_sums_ = all;
        state.largest.add_stress(state.fe_weight * all.largest_load);
        book(state, all);
    }
    ElementSums find_areas(const GoreFrame& part) const {
        return has_.membrane ? ElementSums{}
                             : kernels_.air[static_cast<int>(air_)](part, elements_.membrane, fabric_);
    }
    void finish_pressure(State& state, const ElementSums& all) {
        const ElementSums& areas = has_.membrane ? fabric_sums_ : all;
        if (inflow_) {
            node_loads_.on_fabric += inflow_->set_pressure(
                state, areas, inflow_->openings([this](std::size_t k) { return edge_node(k); }));
        } else {
            state.air.projected_area = areas.positive_area;
            state.air.signed_area = areas.signed_area;
            node_loads_.on_fabric +=
                set_pressure(state.air, smallest_projected_area(scene_.parachutes.front()));
        }
        step_.pressure = state.air.pressure;
    }
    /// Where the nodes along openings are.
    void find_edges() {
        std::unordered_map<NodeIndex, std::array<int, 2>> of_node;  // local number, gore
        for (int gore = 0; gore < gores_.count; ++gore)
            for (LocalNode n = 0; n < gores_.canopy; ++n)
                of_node[gores_.node[gore * gores_.own + n]] = {n, gore};
        for (const NodeIndex i : inflow_->edges())
            edge_nodes_.push_back(of_node.at(i));
    }
    NodeRecord edge_node(std::size_t k) const {
        const auto [n, gore] = edge_nodes_[k];
        NodeRecord node{splat(0.0), splat(0.0)};
        for (int c = 0; c < 3; ++c) {
            node.x[c] = nodes_->at(nodes_->frame.x, n, gore, c);
            node.v[c] = nodes_->at(nodes_->frame.v, n, gore, c);
        }
        return node;
    }
    ElementSums drag_fabric(const GoreFrame& part) const {
        return kernels_.fabric_drag(part, elements_.membrane,
                                    {0.5 * density_ * fabric_drag_coefficient(scene_), wind_});
    }
    void finish_fabric_drag(State& state, const ElementSums& all) {
        state.air.projected_area = all.positive_area;
    }

    void prepare_springs(const ForceModel&) {
        elements_.springs = gore_springs(gores_, mesh_.fabric, scene_.full, deploy().deployment_resistance);
    }
    SpringPass edges() const {
        return {deploy().compressive_stiffness_ratio, has_.springs, has_.folds, bound_->folded()};
    }
    ElementSums stretch_edges(const GoreFrame& part) const {
        return kernels_.springs(part, elements_.springs, edges());
    }
    EnergyAndStrain edge_levels(const State& state) const {
        return kernels_.spring_levels(nodes_->up_to_date(state), elements_.springs, edges());
    }
    /// Springs take the folds along: both need the same lengths.
    ElementSums hold_folds(const GoreFrame& part) const {
        return has_.springs ? ElementSums{} : stretch_edges(part);
    }

    // --- contact --------------------------------------------------------------------------

    void prepare_self_contact(const ForceModel& model) {
        self_contact_ = std::make_unique<GoreSelfContact>(dynamic_cast<const SelfContact&>(model), gores_,
                                                          *nodes_, kernels_, mesh_.payload());
    }
    void push_folds(State& state, const ElementSums&) { self_contact_->push(state); }
    /// Contact on lines is no drag: with the velocity that the kernel's node update will book it at.
    void take_out_contact(StepSums& sums) const {
        for (const auto& [n, gore, force] : self_contact_->on_lines()) {
            const auto row = [&, n = n, gore = gore](double* array) {
                return Lanes{nodes_->at(array, n, gore, 0), nodes_->at(array, n, gore, 1),
                             nodes_->at(array, n, gore, 2), 0.0};
            };
            const Lanes pull = row(nodes_->frame.force);
            const double mass = node_[n].mass, inverse = inverse_inertia_[n];
            Lanes others = row(nodes_->frame.aero), none = splat(0.0);
            others[2] -= mass * step_.gravity;
            law::resist(step_.mass_damping * mass, row(nodes_->frame.v) - as_lanes(step_.system_mean), others,
                        none);
            const Lanes before{nodes_->half_at(n, gore, 0), nodes_->half_at(n, gore, 1),
                               nodes_->half_at(n, gore, 2), 0.0};
            const double pulled = step_.together ? step_.kick : step_.first_kick;
            const Lanes change = 0.5 * inverse * (step_.kick * others + pulled * pull);
            sums.drag_power -= work(force, before + change);
            if (step_.weighs) sums.kinetic -= 0.5 * step_.last_dt * sum3(work(force, change));
        }
    }
    EnergyAndStrain self_contact_levels(const State& state) const {
        return {self_contact_->energy(state), 0.0};
    }

    void prepare_contacts(const ForceModel&) { elements_.contacts = gore_contact_pairs(gores_, mesh_); }
    CanopyAxis axis(const State& state) const {
        return canopy_axis(state.sums.canopy_position, to_vec3(state.node[mesh_.payload()].x));
    }
    ContactPass contact_pass(const CanopyAxis& axis) const {
        return {to_array(axis.canopy), to_array(axis.direction)};
    }
    ElementSums push_apart(const GoreFrame& part) const {
        return kernels_.contacts(part, elements_.contacts, contact_pass(axis_));
    }
    void finish_contacts(State& state, const ElementSums& all) {
        const AxisReaction on = axis_reaction(axis_, Vec3(all.by_arm.data()), Vec3(all.by_turning.data()));
        state.contact_reaction = on.payload;
        state.force[mesh_.payload()].value += to_lanes(on.payload);
        step_.has_contact_reaction = true;
        step_.contact_reaction = to_array(on.canopy / constants_.canopy_mass);
    }
    EnergyAndStrain contact_levels(const State& state) const {
        return kernels_.contact_levels(nodes_->up_to_date(state), elements_.contacts,
                                       contact_pass(axis(state)));
    }

    // --- cables ---------------------------------------------------------------------------

    void prepare_tapes(const ForceModel&) {
        elements_.tapes = gore_cables(gores_.cables, is_tape, mesh_, scene_.full);
    }
    ElementSums stretch_tapes(const GoreFrame& part) const { return kernels_.cables(part, elements_.tapes); }
    EnergyAndStrain tape_levels(const State& state) const {
        return kernels_.cable_levels(nodes_->up_to_date(state), elements_.tapes);
    }
    void collect_lines() {
        const auto is_line = [](CableKind kind) { return !is_tape(kind); };
        elements_.lines = gore_cables(gores_.cables, is_line, mesh_, scene_.full);
    }
    /// The air needs them, too.
    void prepare_line_drag(const ForceModel&) {
        has_.line_drag = true;
        collect_lines();
    }
    void prepare_lines(const ForceModel&) {
        collect_lines();
        elements_.global.push_back(make_cables(mesh_, gores_.global_cables, Block::lines,
                                               scene_.full.bulk_viscosity, scene_.full.beta));
        risers_ = elements_.global.back().get();
        lines_row_ = &*std::ranges::find(rows, Block::lines, &Row::block);
        global_nodes_ = SubcycledNodes(gores_.global, mesh_.first_attachment(), mesh_.attachments.size());
    }
    /// Lines take their drag along: both need the same nodes.
    ElementSums stretch_lines(const GoreFrame& part) const {
        const bool drags = has_.line_drag && density_ > 0.0;  // no Reynolds number without air
        return (drags ? kernels_.lines_with_drag : kernels_.lines)(part, elements_.lines, line_air());
    }
    LineAir line_air() const {
        return {&drag_coefficient_, mesh_.cord(CableKind::line).diameter, density_, viscosity_, wind_};
    }
    /// Adds the forces of risers to the state's forces.
    void finish_lines(State& state, const ElementSums& all) {
        state.largest.add_tension(all.largest_load);
        global_nodes_.note(state, [&] { stretch_risers(state, all.dissipated); });
    }
    void stretch_risers(State& state, double lines_dissipate) {
        const double others = std::exchange(state.damping_power, lines_dissipate);
        risers_->add_forces(state);
        if (body_) body_->pull(state);
        line_damping_ = std::exchange(state.damping_power, others);
    }
    EnergyAndStrain line_levels(const State& state) const {
        return with(kernels_.cable_levels(nodes_->up_to_date(state), elements_.lines), *risers_, state);
    }
    /// Lanes of gores, and what belongs to none.
    EnergyAndStrain with(EnergyAndStrain gores, const ForceModel& global, const State& state) const {
        return {gores.energy + global.energy(state), std::max(gores.strain, global.extreme(state).strain)};
    }
    void prepare_static_line(const ForceModel&) {
        const auto any = [](CableKind) { return true; };
        elements_.cords = gore_cables(gores_.static_line, any, mesh_, scene_.full);
        elements_.global.push_back(make_cables(mesh_, gores_.global_static_line, Block::static_line,
                                               scene_.full.bulk_viscosity, scene_.full.beta));
        static_line_ = elements_.global.back().get();
    }
    ElementSums stretch_cords(const GoreFrame& part) const { return kernels_.cables(part, elements_.cords); }
    void finish_static_line(State& state, const ElementSums& all) {
        book(state, all);
        static_line_->add_forces(state);
    }
    EnergyAndStrain static_line_levels(const State& state) const {
        return with(kernels_.cable_levels(nodes_->up_to_date(state), elements_.cords), *static_line_, state);
    }
    ElementSums drag_lines(const GoreFrame& part) const {
        return lines_row_ || !(density_ > 0.0) ? ElementSums{}
                                               : kernels_.line_drag(part, elements_.lines, line_air());
    }
    void finished(State&, const ElementSums&) {}

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
    void finish_extraction(State& state, const ElementSums&) {
        step_.extraction = to_array(state.air.extraction);
    }
    /// Mass damping of what belongs to no gore.
    void damp_global(State& state) const {
        if (!(node_loads_.mass_damping > 0.0)) return;
        const Lanes mean = to_lanes(node_loads_.system_mean);
        const NodeForces::View on_node = state.force.view();
        Lanes dissipated = splat(0.0);
        for (const NodeIndex i : gores_.global)
            law::resist(node_loads_.mass_damping * constants_.mass[i], state.node[i].v - mean,
                        on_node[i].value, dissipated);
        state.damping_power += sum3(dissipated);
    }

    // --- payload --------------------------------------------------------------------------

    void prepare_tetrahedra(const ForceModel& block) { tetrahedra_ = &block; }
    void finish_tetrahedra(State& state, const ElementSums&) { tetrahedra_->add_forces(state); }
    EnergyAndStrain tetrahedra_levels(const State& state) const { return with({}, *tetrahedra_, state); }
    void prepare_payload_drag(const ForceModel& block) { payload_drag_ = &block; }
    void finish_payload_drag(State& state, const ElementSums&) { payload_drag_->add_forces(state); }

    const Scene& scene_;
    const Mesh& mesh_;
    const NodeConstants& constants_;
    const GoreKernels& kernels_;
    ThreadCountTuner tuner_;
    std::unique_ptr<WorkerPool> threads_;  // if it may be more than one
    Gores gores_;
    std::unique_ptr<GoreNodes> nodes_;
    std::optional<InflowBalance> inflow_;
    std::vector<std::array<int, 2>> edge_nodes_;  // along openings: local number, gore
    AirOnFabric air_ = AirOnFabric::none;
    bool tethered_;                               // to a static line
    std::array<const ForceModels*, 2> models_{};  // of the stage: structure, loads
    std::vector<Acting> structure_, loads_;
    NodeLoads node_loads_;  // of the step
    Has has_;
    std::vector<double*> exchanged_;  // arrays in which gores add to the halo node of the next one's seam

    GoreElements elements_;
    std::unique_ptr<GoreBound> bound_;
    MembranePass fabric_;
    ElementSums fabric_sums_;  // of the last pass over membranes
    std::vector<SumsOfBlock> sums_;
    std::array<double, 3> wind_{};            // [m/s] at the canopy
    double density_ = 0.0, viscosity_ = 0.0;  // of the air [kg/m^3], [Pa s]
    CanopyAxis axis_{};                       // of the step
    CylinderDragTable drag_coefficient_;
    std::vector<GoreNode> node_;
    std::vector<double> inverse_inertia_;
    double inertia_with_ = -1.0;  // [kg] of added mass
    GoreAdvance step_;
    const Row* lines_row_ = nullptr;
    SubcycledNodes global_nodes_;
    double line_damping_ = 0.0;  // [W] of lines and risers
    std::unique_ptr<GoreSelfContact> self_contact_;
    const ForceModel *risers_ = nullptr, *static_line_ = nullptr, *tetrahedra_ = nullptr,
                     *payload_drag_ = nullptr;
};

const std::array<GoreLayout::Row, 14> GoreLayout::rows{{
    {Block::membrane, &GoreLayout::prepare_fabric, &GoreLayout::stretch_membrane,
     &GoreLayout::finish_membrane, &GoreLayout::fabric_levels},
    {Block::fabric_springs, &GoreLayout::prepare_springs, &GoreLayout::stretch_edges, &GoreLayout::book,
     &GoreLayout::edge_levels},
    {Block::tapes, &GoreLayout::prepare_tapes, &GoreLayout::stretch_tapes, &GoreLayout::book,
     &GoreLayout::tape_levels},
    {Block::lines, &GoreLayout::prepare_lines, &GoreLayout::stretch_lines, &GoreLayout::finish_lines,
     &GoreLayout::line_levels},
    {Block::static_line, &GoreLayout::prepare_static_line, &GoreLayout::stretch_cords,
     &GoreLayout::finish_static_line, &GoreLayout::static_line_levels},
    {Block::gore_contact, &GoreLayout::prepare_contacts, &GoreLayout::push_apart,
     &GoreLayout::finish_contacts, &GoreLayout::contact_levels},
    {Block::self_contact, &GoreLayout::prepare_self_contact, nullptr, &GoreLayout::push_folds,
     &GoreLayout::self_contact_levels},
    {Block::payload_tetrahedra, &GoreLayout::prepare_tetrahedra, nullptr, &GoreLayout::finish_tetrahedra,
     &GoreLayout::tetrahedra_levels},
    {Block::canopy_pressure, &GoreLayout::prepare_fabric, &GoreLayout::find_areas,
     &GoreLayout::finish_pressure},
    {Block::fabric_drag, &GoreLayout::prepare_fabric, &GoreLayout::drag_fabric,
     &GoreLayout::finish_fabric_drag},
    {Block::deployment_resistance, &GoreLayout::prepare_springs, &GoreLayout::hold_folds, &GoreLayout::book},
    {Block::extraction, &GoreLayout::prepare_extraction, nullptr, &GoreLayout::finish_extraction},
    {Block::line_drag, &GoreLayout::prepare_line_drag, &GoreLayout::drag_lines, &GoreLayout::finished},
    {Block::payload_drag, &GoreLayout::prepare_payload_drag, nullptr, &GoreLayout::finish_payload_drag},
}};

}  // namespace

std::unique_ptr<Layout> make_gore_layout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants,
                                         const GoreKernels* kernels, int threads) {
    auto gores = find_gores(mesh);
    if (!gores) return nullptr;
    // A thread that has less to do waits for longer than it works.
    const std::size_t elements = mesh.triangles.size() + mesh.cables.size();
    const int worth = static_cast<int>(std::max<std::size_t>(1, elements / elements_of_thread));
    return std::make_unique<GoreLayout>(scene, mesh, constants, std::move(*gores),
                                        kernels ? *kernels : gore_kernels(), std::min(threads, worth));
}

}  // namespace twinchute::fullsim
