// The gore-batched layout: a generated canopy is the same gore over and over, so its elements need neither
// gathers nor scatters.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <unordered_map>

#include <fmt/format.h>

#include "fullsim/forces/canopy_pressure.hpp"
#include "fullsim/forces/gore_contact.hpp"
#include "fullsim/forces/inflow.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/mesh/gore_contacts.hpp"
#include "fullsim/mesh/gores.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/storage/gore_batched/gore_nodes.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"
#include "fullsim/storage/gore_batched/thread_count_tuner.hpp"
#include "fullsim/storage/gore_batched/worker_pool.hpp"
#include "fullsim/storage/layout.hpp"
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
          fabric_area_(mesh.fabric_area()),
          inflow_(InflowBalance::of(scene, mesh)),
          tethered_(!mesh.static_line.cables.empty()) {
        if (threads > 1) threads_ = std::make_unique<WorkerPool>(threads - 1);
        if (inflow_) find_skirt();
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
        const auto has_row = [this](const auto& model) { return row_of(model->block()) != nullptr; };
        has_.own_loops = !std::ranges::all_of(structure, has_row) || !std::ranges::all_of(loads, has_row);
        has_.air_on_fabric = acts(Block::fabric_drag) || has_.own_loops;
        nodes_ = std::make_unique<GoreNodes>(gores_, kernels_.lanes,
                                             what_air_does(acts(Block::canopy_pressure), has_.air_on_fabric));
        rows_ = std::make_unique<GoreNodes>(gores_, kernels_.lanes, GoreNodes::What::row_sums);
        clear_forces(state, has_.own_loops ? 0 : first_held());
        nodes_->load(state);
        step_ = {};
        inertia_with_ = -1.0;
        line_damping_ = 0.0;
        lines_row_ = nullptr;
        structure_.clear();
        loads_.clear();
        tapes_.clear();
        lines_.clear();
        cords_.clear();
        contacts_.clear();
        global_.clear();
        springs_ = {};
        make_nodes();
        sums_.assign(nodes_->frame.blocks, {});
        for (const ForceModels* models : {&structure, &loads})
            for (const auto& model : *models) {
                const Row* row = row_of(model->block());
                (models == &structure ? structure_ : loads_).push_back({row, model.get()});
                if (row) (this->*row->prepare)(*model);
            }
        has_.springs = acts(Block::fabric_springs);
        has_.membrane = acts(Block::membrane);
        has_.pressure = acts(Block::canopy_pressure);
        air_ = !has_.pressure ? AirOnFabric::none : inflow_ ? AirOnFabric::fills : AirOnFabric::pushes;
        has_.folds = acts(Block::deployment_resistance);
        has_.breathing = acts(Block::breathing_damping);
        has_.accretion = acts(Block::accretion);
        has_.mass_damping = acts(Block::mass_damping);
        exchanged_ = {nodes_->frame.force};
        if (has_.air_on_fabric) exchanged_.push_back(nodes_->frame.aero);  // lines see no halo node
        if (has_.pressure) exchanged_.push_back(nodes_->frame.push);
        weights_.begin(state, constants_, structure, find_block(structure, Block::lines));
        weigh_rows(state);
    }

    void store(State& state) const override { nodes_->store(state); }

    std::vector<PlanArray> arrays() const override {
        std::vector<PlanArray> all;
        add_bytes(all, "nodes of gores", nodes_->bytes() + rows_->bytes() + bytes_of(node_));
        // Canopy pressure, fabric drag and membranes read the same constants of triangles.
        add_bytes(all, "triangles", bytes_of(membrane_) + bytes_of(triangle_rows_));
        // Springs and deployment resistance those of edges.
        add_bytes(all, "edges", bytes_of(springs_) + bytes_of(spring_columns_));
        add_bytes(all, "tapes", bytes_of(tapes_));
        add_bytes(all, "lines", bytes_of(lines_));
        add_bytes(all, "static line", bytes_of(cords_));
        add_bytes(all, "gore contact", bytes_of(contacts_));
        return all;
    }

    double membrane_energy(State& state) const override {
        return kernels_.membrane_levels(nodes_->up_to_date(state), membrane_, fabric_).energy;
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
        for (const auto& [row, model] : structure_)
            if (is_folding_fabric(model->block()))
                longest = std::max(longest, (this->*row->levels)(state).strain);
        return longest;
    }

    void evaluate(State& state, BlockClock& clock) override {
        count_time();
        use_air(state);
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
        state.riser_force = to_vec3(state.force[mesh_.payload()].value);
        run(loads_);
        if (has_.own_loops) nodes_->scatter_add_forces(state);
        if (!at_once) for_parts([&](const GoreFrame& part) { reduce_block(part.first); });
    }

    CriticalSteps critical_steps(const State& state) override {
        if (has_.own_loops) {
            weights_.renew(state);
            const double all =
                critical_step(stored(state), constants_, *models_[0], *models_[1], weights_.by_node()).dt;
            return {all, all, all};  // without subcycles
        }
        if (weights_.renew(state) || state.folded != folded_) weigh_rows(state);
        const GoreFrame& sums = rows_->frame;
        for (LocalNode n = 0; n < sums.nodes; ++n)
            set_rows(n, slow_rows_[n < sums.own ? n : n - sums.own + gores_.own]);
        fabric_.weight = state.fe_weight;
        for_parts([&](const GoreFrame& part) {
            nodes_->gather_halo(part.first);
            if (has_.membrane) kernels_.membrane_rows(part, membrane_, triangle_rows_, fabric_.weight, sums);
            if (has_.springs || has_.folds)
                kernels_.spring_rows(part, springs_, edges(), spring_columns_, sums);
        });
        kernels_.scatter_add_halo(sums, gores_.neighbour);
        const double by_share = (has_.breathing ? breathing(state.air) : 0.0) +
                                (has_.accretion ? state.accretion() : 0.0);
        find_inverse_inertia(state);
        for (LocalNode n = 0; n < gores_.canopy; ++n)
            node_damping_[n] = by_share * node_[n].share + by_mass() * node_[n].mass;
        const auto bound = [&](LocalNode first, LocalNode last) {
            return kernels_.critical_step(sums, inverse_inertia_, node_damping_, first, last);
        };
        const double inner = std::min(bound(0, gores_.inner), static_line_step_);
        CriticalSteps steps;
        steps.canopy = std::min(inner, bound(gores_.inner, gores_.canopy));
        steps.lines = line_step_;
        for (LocalNode n = gores_.inner; n < gores_.canopy; ++n) {
            steps.lines = std::min(
                steps.lines, critical_step_of(line_rows_[n][0], line_rows_[n][1], 1.0 / inverse_inertia_[n]));
            add_rows(n, line_rows_[n]);
        }
        steps.all = std::min({inner, bound(gores_.inner, gores_.canopy), line_step_});
        return steps;
    }

    void advance(State& state, double dt, int subcycles, double next_added_mass) override {
        const bool together = subcycles == 1;
        if (together)
            state.damping_power += line_damping_;
        else
            global_nodes_.take_others(state);  // nothing but lines acts on links by way of gores
        nodes_->scatter_add_shared(0, state.force);
        nodes_->scatter_add_shared(1, state.aero);
        NodeMover mover(state, constants_, dt);
        find_inverse_inertia(state);
        step_.nodes = node_;
        step_.inverse_inertia = inverse_inertia_;
        step_.kick = mover.kick();
        step_.dt = dt;
        // Until snatch the air acts on every triangle; then it does through `push`, and as line drag on the
        // skirt.
        step_.first_aero = has_.air_on_fabric ? 0 : gores_.inner;
        step_.first_pulled = gores_.inner;
        step_.together = together;
        const GoreSubcycle first = subcycle_of(state, dt, subcycles, 0);
        step_.first_kick = first.step.kick;
        step_.weighs = state.energy.weighs;
        step_.last_dt = state.dt;
        step_.last_line_dt = state.line_dt;
        step_.gravity = constants_.gravity;
        step_.halo = nodes_->halo();
        step_.pushed = has_.pressure;
        step_.halo_aero = has_.air_on_fabric;
        for_parts([&](const GoreFrame& part) {
            nodes_->receive_halo_forces(part.first, exchanged_);
            sums_[part.first].step = kernels_.advance(part, step_);
            if (together)
                nodes_->send_first_gore(part.first);
            else
                kernels_.subcycle(part, first);  // of gores alone: it asks for no forces
        });

        StepSums sums;
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
        if (together) {
            mover.move_others(gores_.global, constants_, sums);
            if (body_) body_->advance(state, mover.kick(), dt);
        } else
            for (std::size_t k = 0; k < gores_.global.size(); ++k) {
                const NodeIndex i = gores_.global[k];
                mover.kick_alone(i, global_nodes_.others(k), constants_.mass[i], constants_.mass[i],
                                 step_.first_kick, sums);
            }
        mover.move_static_line(constants_, sums);
        if (!together) take_subcycles(state, mover, dt, subcycles, sums);
        finish_step(state, constants_, sums, mover.kick(), dt, dt / subcycles, next_added_mass);
    }

    void serialize(Archive& archive, const State& state) override {
        nodes_->serialize(archive);
        weights_.serialize(archive);
        if (archive.reads()) weigh_rows(state);
    }

private:
    /// How a block of the registry acts on batches of gores.
    struct Row {
        Block block;
        void (GoreLayout::*prepare)(const ForceModel&);
        ElementSums (GoreLayout::*work)(const GoreFrame&) const;  // on some gores; null: nothing
        /// With the sums of all gores: what is left to do, once.
        void (GoreLayout::*finish)(State&, const ElementSums&);
        EnergyAndStrain (GoreLayout::*levels)(const State&) const = nullptr;  // of structure
    };
    static const std::array<Row, 16> rows;
    const Row* row_of(Block block) const {
        // Tetrahedra act on nodes of the state, where there is a body at all.
        if (block == Block::payload_tetrahedra && mesh_.attachments.empty()) return nullptr;
        const auto row = std::ranges::find(rows, block, &Row::block);
        return row == rows.end() ? nullptr : &*row;
    }
    /// A block of the stage. Without a row it acts by its own loop on the records of the state: slower, and
    /// right.
    struct Acting {
        const Row* row;
        const ForceModel* model;
    };

    /// On lines of its own, since another thread writes those of the next block.
    struct alignas(128) SumsOfBlock {
        std::array<ElementSums, 16> of_row{};  // of the last pass of each row of the table
        GoreSums step;
    };

    struct Has {
        bool springs = false, membrane = false, pressure = false, folds = false, air_on_fabric = false;
        bool own_loops = false;  // of blocks without a row here
        bool breathing = false, accretion = false, mass_damping = false, line_drag = false;
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

    /// From the last step to this.
    void count_time() {
        if (tuner_.most() == 1) return;
        const auto now = std::chrono::steady_clock::now();
        if (step_began_) tuner_.took(std::chrono::duration<double>(now - *step_began_).count());
        step_began_ = now;
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

    GoreSubcycle subcycle_of(const State& state, double dt, int count, int k) const {
        return {node_,
                inverse_inertia_,
                lines_,
                k == 0,
                nodes_->halo()[gores_.inner],
                subcycle(state, dt, count, k),
                k + 1 == count ? 0.5 * dt : 0.0};
    }

    /// Skirt, lines, links, risers and payload, which have had the impulse of everything else; in the first,
    /// which gores have taken, the others alone.
    void take_subcycles(State& state, NodeMover& mover, double dt, int count, StepSums& sums) {
        if (body_) body_->impulse(state, mover.kick());
        for (int k = 0; k < count; ++k) {
            const bool last = k + 1 == count;
            const GoreSubcycle move = subcycle_of(state, dt, count, k);
            if (k > 0) {
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
            sums.line_damping += move.step.kick * line_damping_;
            for (const NodeIndex i : gores_.global)
                mover.move_in_subcycle(i, constants_.mass[i], move.step);
            if (body_) body_->move(state, move.step.kick, move.step.dt);
        }
        for (const SumsOfBlock& of_part : sums_)
            add_positions(of_part.step, sums);
        sums.line_damping_power = line_damping_ / count;
        for (const NodeIndex i : gores_.global) {
            mover.end_subcycles(i);
            mover.add_other(i, constants_.mass[i], sums);
        }
        if (body_) body_->finish(state, dt);
    }

    // --- the critical time step ------------------------------------------------------------------

    using NodeRows = std::array<double, 2>;  // stiffness [N/m], damping [N s/m]

    void set_rows(LocalNode n, const NodeRows& of_node) const {
        for (int block = 0; block < rows_->frame.blocks; ++block)
            for (int what = 0; what < 2; ++what)
                std::fill_n(rows_->frame.x + rows_->frame.at(block, n) +
                                static_cast<std::ptrdiff_t>(what) * rows_->frame.lanes,
                            rows_->frame.lanes, of_node[what]);
    }
    void add_rows(LocalNode n, const NodeRows& of_node) const {
        for (int gore = 0; gore < gores_.count; ++gore)
            for (int what = 0; what < 2; ++what)
                rows_->at(rows_->frame.x, n, gore, what) += of_node[what];
    }

    /// [1/s] mass damping.
    double by_mass() const { return has_.mass_damping ? scene_.full.alpha : 0.0; }

    /// Weight of a node in row sums.
    double weight(LocalNode n) const {
        const LocalNode first_shared = gores_.local_nodes() - static_cast<LocalNode>(gores_.shared.size());
        if (n >= first_shared) return weights_.by_node()[gores_.shared[n - first_shared].front()];
        return weights_.by_node()[gores_.node[n < gores_.own ? n : gores_.neighbour[n - gores_.own]]];
    }
    /// Computes the row sums of the blocks as they are now.
    void weigh_rows(const State& state) {
        folded_ = state.folded;
        const MembraneLaw law = membrane_law(mesh_.fabric, scene_.full.bulk_viscosity);
        triangle_rows_.clear();
        if (has_.membrane) triangle_rows_.reserve(gores_.triangles.size());
        for (const GoreTriangle& t : gores_.triangles) {
            if (!has_.membrane) break;
            const TriangleRows flat = unstrained_rows(law, {{}, t.a, t.b, t.c});
            const std::array<double, 3> weights{weight(t.node[0]), weight(t.node[1]), weight(t.node[2])};
            WeighedRows weighed{};
            for (int i = 0; i < 3; ++i) {
                weighed.stiffness[i] = flat.stiffness(i, weights);
                weighed.damping[i] = flat.damping * weighed.stiffness[i];
            }
            triangle_rows_.push_back(weighed);
        }
        spring_columns_ = {};
        for (const GoreEdge& e : gores_.edges) {
            if (!has_.springs && !has_.folds) break;
            const double ratio = weight(e.node[1]) / weight(e.node[0]);
            spring_columns_.push_back({1.0 + ratio, 1.0 + 1.0 / ratio});
        }
        bound_cables(state);
    }

    /// Row sums that do not change: of cables, slack ones too, since they may pull tight any time. With them
    /// the bounds of nodes that hold nothing else.
    void bound_cables(const State& state) {
        slow_rows_.assign(gores_.local_nodes(), {0.0, 0.0});
        line_rows_ = slow_rows_;
        node_damping_.assign(gores_.own, 0.0);
        const auto collect = [](const std::vector<CableElement>& cables, std::vector<NodeRows>& of_nodes,
                                auto&& weight_of) {
            for (const CableElement& c : cables)
                for (int end = 0; end < 2; ++end) {
                    const LocalNode n = c.node[end];
                    const double columns = 1.0 + weight_of(c.node[1 - end]) / weight_of(n);
                    of_nodes[n][0] += columns * c.stiffness * c.inverse_length;
                    of_nodes[n][1] += columns * c.dashpot;
                }
        };
        const auto weighed = [this](LocalNode n) { return weight(n); };
        const auto alike = [](LocalNode) { return 1.0; };
        if (!folded_) collect(tapes_, slow_rows_, weighed);
        collect(cords_, slow_rows_, weighed);
        for (const ContactElement& pair : contacts_)
            for (int end = 0; end < 2; ++end)
                slow_rows_[pair.node[end]][0] += (1.0 + weight(pair.node[1 - end]) / weight(pair.node[end])) *
                                                 contact_tangent(pair.stiffness);
        collect(lines_, line_rows_, alike);

        GershgorinSums global = no_rows(state, weights_.by_node());
        for (const auto& cables : global_)
            cables->add_row_sums(state, global);
        for (std::size_t k = 0; k < gores_.shared.size(); ++k) {
            const std::size_t n = gores_.own + gores_.neighbour.size() + k;
            for (const NodeIndex i : gores_.shared[k]) {
                global.stiffness[i] += slow_rows_[n][0] + line_rows_[n][0];
                global.damping[i] += slow_rows_[n][1] + line_rows_[n][1];
            }
        }
        line_step_ = static_line_step_ = std::numeric_limits<double>::infinity();
        for (LocalNode n = gores_.canopy; n < gores_.own; ++n)
            line_step_ = std::min(
                line_step_, critical_step_of(line_rows_[n][0], line_rows_[n][1] + by_mass() * node_[n].mass,
                                             node_[n].mass));
        for (const NodeIndex i : gores_.global)
            line_step_ =
                std::min(line_step_, critical_step_of(global.stiffness[i],
                                                      global.damping[i] + by_mass() * constants_.mass[i],
                                                      constants_.mass[i]));
        const auto& line = constants_.static_line_mass;
        const std::size_t first = constants_.first_static_line();
        for (std::size_t k = 0; k + 1 < line.size(); ++k)  // its anchor is not accelerated
            static_line_step_ =
                std::min(static_line_step_,
                         critical_step_of(global.stiffness[first + k], global.damping[first + k], line[k]));
    }

    void nothing(const ForceModel&) {}
    void book(State& state, const ElementSums& all) { state.damping_power += all.dissipated; }

    // --- fabric ---------------------------------------------------------------------------

    void prepare_fabric(const ForceModel&) {
        const MembraneLaw law = membrane_law(mesh_.fabric, scene_.full.bulk_viscosity);
        membrane_.clear();
        membrane_.reserve(gores_.triangles.size());
        for (const GoreTriangle& t : gores_.triangles)
            membrane_.push_back({{t.node[0], t.node[1], t.node[2]},
                                 1.0 / t.a,
                                 1.0 / t.c,
                                 t.b / t.a,
                                 0.5 * t.a * t.c,
                                 law.viscosity * element_length({{}, t.a, t.b, t.c})});
        fabric_ = {law};
    }

    void use_air(const State& state) {
        fabric_.direction = to_array(state.air.direction);
        fabric_.radial_pressure = state.air.radial_pressure;
        fabric_.weight = state.fe_weight;
        wind_ = to_array(state.air.wind);
        if (!contacts_.empty()) axis_ = axis(state);
        density_ = state.air.density;
        viscosity_ = state.air.viscosity;
    }
    EnergyAndStrain fabric_levels(const State& state) const {
        // Fabric that is held by springs still carries its share only.
        EnergyAndStrain levels = kernels_.membrane_levels(nodes_->up_to_date(state), membrane_, fabric_);
        levels.energy *= state.fe_weight;
        levels.strain *= state.fe_weight;
        return levels;
    }
    /// Membranes, and the areas that pressure acts on with them.
    ElementSums stretch_membrane(const GoreFrame& part) const {
        return kernels_.membrane[static_cast<int>(air_)](part, membrane_, fabric_);
    }
    void finish_membrane(State& state, const ElementSums& all) {
        fabric_sums_ = all;
        state.largest.add_stress(state.fe_weight * all.largest_load);
        book(state, all);
    }
    ElementSums find_areas(const GoreFrame& part) const {
        return has_.membrane ? ElementSums{} : kernels_.air[static_cast<int>(air_)](part, membrane_, fabric_);
    }
    void finish_pressure(State& state, const ElementSums& all) {
        const ElementSums& areas = has_.membrane ? fabric_sums_ : all;
        if (inflow_) {
            step_.residual_drag = to_array(inflow_->set_pressure(
                state, areas, inflow_->mouth([this](std::size_t k) { return skirt_node(k); })));
        } else {
            state.air.projected_area = areas.positive_area;
            state.air.signed_area = areas.signed_area;
            step_.residual_drag =
                to_array(set_pressure(state.air, smallest_projected_area(scene_.parachutes.front())));
        }
        step_.pressure = state.air.pressure;
    }
    /// Where the nodes around the mouth are.
    void find_skirt() {
        std::unordered_map<NodeIndex, std::array<int, 2>> of_node;  // local number, gore
        for (int gore = 0; gore < gores_.count; ++gore)
            for (LocalNode n = 0; n < gores_.canopy; ++n)
                of_node[gores_.node[gore * gores_.own + n]] = {n, gore};
        for (const NodeIndex i : inflow_->skirt())
            skirt_.push_back(of_node.at(i));
    }
    NodeRecord skirt_node(std::size_t k) const {
        const auto [n, gore] = skirt_[k];
        NodeRecord node{splat(0.0), splat(0.0)};
        for (int c = 0; c < 3; ++c) {
            node.x[c] = nodes_->at(nodes_->frame.x, n, gore, c);
            node.v[c] = nodes_->at(nodes_->frame.v, n, gore, c);
        }
        return node;
    }
    ElementSums drag_fabric(const GoreFrame& part) const {
        return kernels_.fabric_drag(part, membrane_, {0.5 * density_ * deploy().drag_coefficient, wind_});
    }
    void finish_fabric_drag(State& state, const ElementSums& all) {
        state.air.projected_area = all.positive_area;
    }

    void prepare_springs(const ForceModel&) {
        springs_.clear();
        for (const GoreEdge& e : gores_.edges) {
            const SpringConstants k =
                fabric_spring_constants(mesh_.fabric, e, scene_.full.bulk_viscosity, scene_.full.beta);
            springs_.push_back({{e.node[0], e.node[1]},
                                k.inverse_length,
                                k.stiffness,
                                k.hardening,
                                k.dashpot,
                                fold_force(mesh_.fabric, e, deploy().deployment_resistance)});
        }
    }
    SpringPass edges() const {
        return {deploy().compressive_stiffness_ratio, has_.springs, has_.folds, folded_};
    }
    ElementSums stretch_edges(const GoreFrame& part) const {
        return kernels_.springs(part, springs_, edges());
    }
    EnergyAndStrain edge_levels(const State& state) const {
        return kernels_.spring_levels(nodes_->up_to_date(state), springs_, edges());
    }
    /// Springs take the folds along: both need the same lengths.
    ElementSums hold_folds(const GoreFrame& part) const {
        return has_.springs ? ElementSums{} : stretch_edges(part);
    }

    // --- contact --------------------------------------------------------------------------

    void prepare_contacts(const ForceModel&) {
        std::unordered_map<NodeIndex, LocalNode> local;
        for (LocalNode n = 0; n < gores_.own; ++n)
            local.emplace(gores_.node[n], n);
        for (std::size_t k = 0; k < gores_.neighbour.size(); ++k)
            local.emplace(gores_.node[gores_.own + gores_.neighbour[k]],
                          gores_.own + static_cast<LocalNode>(k));
        for (const auto& [node, stiffness] : local_contacts(mesh_, 1, local))
            contacts_.push_back({{node[0], node[1]}, stiffness});
    }
    CanopyAxis axis(const State& state) const {
        return canopy_axis(state.sums.canopy_position, to_vec3(state.node[mesh_.payload()].x));
    }
    ContactPass contact_pass(const CanopyAxis& axis) const {
        return {to_array(axis.canopy), to_array(axis.direction)};
    }
    ElementSums push_apart(const GoreFrame& part) const {
        return kernels_.contacts(part, contacts_, contact_pass(axis_));
    }
    void finish_contacts(State& state, const ElementSums& all) {
        const AxisReaction on = axis_reaction(axis_, Vec3(all.by_arm.data()), Vec3(all.by_turning.data()));
        state.force[mesh_.payload()].value += to_lanes(on.payload);
        step_.has_contact_reaction = true;
        step_.contact_reaction = to_array(on.canopy / constants_.canopy_mass);
    }
    EnergyAndStrain contact_levels(const State& state) const {
        return kernels_.contact_levels(nodes_->up_to_date(state), contacts_, contact_pass(axis(state)));
    }

    // --- cables ---------------------------------------------------------------------------

    CableElement cable(const GoreCable& c) const {
        const Cable as_indexed{{c.node[0], c.node[1]}, c.rest_length, c.strands, c.kind};
        const CableConstants k =
            cable_constants(mesh_, as_indexed, scene_.full.bulk_viscosity, scene_.full.beta);
        return {{c.node[0], c.node[1]}, 1.0 / c.rest_length, k.stiffness, k.dashpot};
    }
    void prepare_tapes(const ForceModel&) {
        for (const GoreCable& c : gores_.cables)
            if (is_tape(c.kind)) tapes_.push_back(cable(c));
    }
    ElementSums stretch_tapes(const GoreFrame& part) const { return kernels_.cables(part, tapes_); }
    EnergyAndStrain tape_levels(const State& state) const {
        return kernels_.cable_levels(nodes_->up_to_date(state), tapes_);
    }
    void collect_lines() {
        lines_.clear();
        for (const GoreCable& c : gores_.cables)
            if (!is_tape(c.kind)) lines_.push_back(cable(c));
    }
    /// The air needs them, too.
    void prepare_line_drag(const ForceModel&) {
        has_.line_drag = true;
        collect_lines();
    }
    void prepare_lines(const ForceModel&) {
        collect_lines();
        global_.push_back(make_cables(mesh_, gores_.global_cables, Block::lines, scene_.full.bulk_viscosity,
                                      scene_.full.beta));
        risers_ = global_.back().get();
        lines_row_ = &*std::ranges::find(rows, Block::lines, &Row::block);
        global_nodes_ = SubcycledNodes(gores_.global, mesh_.first_attachment(), mesh_.attachments.size());
    }
    /// Lines take their drag along: both need the same nodes.
    ElementSums stretch_lines(const GoreFrame& part) const {
        const bool drags = has_.line_drag && density_ > 0.0;  // no Reynolds number without air
        return (drags ? kernels_.lines_with_drag : kernels_.lines)(part, lines_, line_air());
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
        return with(kernels_.cable_levels(nodes_->up_to_date(state), lines_), *risers_, state);
    }
    /// Lanes of gores, and what belongs to none.
    EnergyAndStrain with(EnergyAndStrain gores, const ForceModel& global, const State& state) const {
        return {gores.energy + global.energy(state), std::max(gores.strain, global.extreme(state).strain)};
    }
    void prepare_static_line(const ForceModel&) {
        for (const GoreCable& c : gores_.static_line)
            cords_.push_back(cable(c));
        global_.push_back(make_cables(mesh_, gores_.global_static_line, Block::static_line,
                                      scene_.full.bulk_viscosity, scene_.full.beta));
        static_line_ = global_.back().get();
    }
    ElementSums stretch_cords(const GoreFrame& part) const { return kernels_.cables(part, cords_); }
    void finish_static_line(State& state, const ElementSums& all) {
        book(state, all);
        static_line_->add_forces(state);
    }
    EnergyAndStrain static_line_levels(const State& state) const {
        return with(kernels_.cable_levels(nodes_->up_to_date(state), cords_), *static_line_, state);
    }
    ElementSums drag_lines(const GoreFrame& part) const {
        return lines_row_ || !(density_ > 0.0) ? ElementSums{} : kernels_.line_drag(part, lines_, line_air());
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
        step_.extraction = to_array(deploy().extraction.at(state.time) * trailing_direction(scene_));
    }
    /// [N s/m] of the whole canopy.
    double breathing(const AeroState& air) const {
        return *scene_.aerodynamics.breathing_damping * air.density * air.airspeed * fabric_area_;
    }
    void finish_breathing(State& state, const ElementSums&) {
        step_.breathing = breathing(state.air);
        step_.breathing_mean = to_array(state.sums.canopy_area_velocity);
    }
    void finish_accretion(State& state, const ElementSums&) {
        step_.accretion = state.accretion();
        step_.wind = to_array(state.air.wind);
    }
    void finish_mass_damping(State& state, const ElementSums&) {
        step_.alpha = scene_.full.alpha;
        step_.mean = to_array(state.sums.system_velocity);
        const Lanes mean = to_lanes(state.sums.system_velocity);
        const NodeForces::View on_node = state.force.view();
        Lanes dissipated = splat(0.0);
        for (const NodeIndex i : gores_.global)
            law::resist(step_.alpha * constants_.mass[i], state.node[i].v - mean, on_node[i].value,
                        dissipated);
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
    std::optional<std::chrono::steady_clock::time_point> step_began_;
    Gores gores_;
    std::unique_ptr<GoreNodes> nodes_, rows_;  // all arrays, and row sums
    double fabric_area_;                       // [m^2]
    std::optional<InflowBalance> inflow_;
    std::vector<std::array<int, 2>> skirt_;  // nodes around the mouth: local number, gore
    AirOnFabric air_ = AirOnFabric::none;
    bool tethered_;                               // to a static line
    std::array<const ForceModels*, 2> models_{};  // of the stage: structure, loads
    std::vector<Acting> structure_, loads_;
    Has has_;
    std::vector<double*> exchanged_;  // arrays in which gores add to the halo node of the next one's seam

    std::vector<MembraneElement> membrane_;
    MembranePass fabric_;
    ElementSums fabric_sums_;  // of the last pass over membranes
    std::vector<SumsOfBlock> sums_;
    std::array<double, 3> wind_{};            // [m/s] at the canopy
    double density_ = 0.0, viscosity_ = 0.0;  // of the air [kg/m^3], [Pa s]
    std::vector<SpringElement> springs_;
    std::vector<CableElement> tapes_, lines_, cords_;
    std::vector<ContactElement> contacts_;
    CanopyAxis axis_{};  // of the step
    CylinderDragTable drag_coefficient_;
    std::vector<GoreNode> node_;
    std::vector<double> inverse_inertia_, node_damping_;
    double inertia_with_ = -1.0;                   // [kg] of added mass
    std::vector<NodeRows> slow_rows_, line_rows_;  // of each local node: tapes and cords, lines
    double line_step_ = 0.0,
           static_line_step_ = 0.0;  // [s] bounds of line, link and riser nodes; of its nodes
    PerronScaling weights_;
    bool folded_ = false;  // the fabric, for the bound
    std::vector<WeighedRows> triangle_rows_;
    std::vector<std::array<double, 2>> spring_columns_;
    GoreAdvance step_;
    ForceModels global_;  // cables that belong to no gore
    const Row* lines_row_ = nullptr;
    SubcycledNodes global_nodes_;
    double line_damping_ = 0.0;  // [W] of lines and risers
    const ForceModel *risers_ = nullptr, *static_line_ = nullptr, *tetrahedra_ = nullptr,
                     *payload_drag_ = nullptr;
};

const std::array<GoreLayout::Row, 16> GoreLayout::rows{{
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
    {Block::payload_tetrahedra, &GoreLayout::prepare_tetrahedra, nullptr, &GoreLayout::finish_tetrahedra,
     &GoreLayout::tetrahedra_levels},
    {Block::canopy_pressure, &GoreLayout::prepare_fabric, &GoreLayout::find_areas,
     &GoreLayout::finish_pressure},
    {Block::fabric_drag, &GoreLayout::prepare_fabric, &GoreLayout::drag_fabric,
     &GoreLayout::finish_fabric_drag},
    {Block::deployment_resistance, &GoreLayout::prepare_springs, &GoreLayout::hold_folds, &GoreLayout::book},
    {Block::extraction, &GoreLayout::prepare_extraction, nullptr, &GoreLayout::finish_extraction},
    {Block::line_drag, &GoreLayout::prepare_line_drag, &GoreLayout::drag_lines, &GoreLayout::finished},
    {Block::breathing_damping, &GoreLayout::nothing, nullptr, &GoreLayout::finish_breathing},
    {Block::payload_drag, &GoreLayout::prepare_payload_drag, nullptr, &GoreLayout::finish_payload_drag},
    {Block::accretion, &GoreLayout::nothing, nullptr, &GoreLayout::finish_accretion},
    {Block::mass_damping, &GoreLayout::nothing, nullptr, &GoreLayout::finish_mass_damping},
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
