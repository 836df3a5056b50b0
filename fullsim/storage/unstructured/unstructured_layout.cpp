// Nodes as the state's own records and elements that name theirs: any mesh. Several elements at once, whose
// corners are loaded as records and turned to columns in registers.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <memory>
#include <span>
#include <utility>

#include "fullsim/forces/canopy_pressure.hpp"
#include "fullsim/forces/gore_contact.hpp"
#include "fullsim/forces/inflow.hpp"
#include "fullsim/forces/node_loads.hpp"
#include "fullsim/forces/registry.hpp"
#include "fullsim/forces/spring.hpp"
#include "fullsim/mesh/gore_contacts.hpp"
#include "fullsim/storage/layout.hpp"
#include "fullsim/storage/unstructured/element_list.hpp"
#include "fullsim/storage/unstructured/kernels.hpp"
#include "fullsim/storage/unstructured/quads.hpp"
#include "fullsim/threads/thread_count_tuner.hpp"
#include "fullsim/threads/worker_pool.hpp"
#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/energy.hpp"
#include "fullsim/time/node_mover.hpp"
#include "fullsim/time/subcycling.hpp"
#include "lib/scene/line_stretch.hpp"

namespace twinchute::fullsim {
namespace {

std::array<double, 3> to_array3(const Vec3& a) {
    return {a.x(), a.y(), a.z()};
}
std::array<double, 4> to_array4(const Vec3& a) {
    return {a.x(), a.y(), a.z(), 0.0};
}
Lanes as_lanes(const std::array<double, 4>& a) {
    return Lanes{a[0], a[1], a[2], a[3]};
}

/// Records of whole rows of doubles.
template <class Record>
double* doubles(std::vector<Record>& records) {
    return reinterpret_cast<double*>(records.data());
}

class UnstructuredLayout final : public Layout {
public:
    UnstructuredLayout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants,
                       const unstructured::Kernels& kernels, int threads)
        : scene_(scene),
          mesh_(mesh),
          constants_(constants),
          kernels_(kernels),
          inflow_(InflowBalance::of(scene, mesh)),
          parts_(mesh),
          of_list_(parts_.lists()),
          moved_(parts_.count()),
          tuner_(std::min(threads, static_cast<int>(parts_.count()))) {
        if (tuner_.most() > 1) threads_ = std::make_unique<WorkerPool>(tuner_.most() - 1);
    }

    std::string_view name() const override { return "unstructured"; }
    int threads() const override { return tuner_.most(); }
    std::string_view instruction_set() const override { return kernels_.instruction_set; }

    void begin(State& state, const ForceModels& structure, const ForceModels& loads,
               const Body* body) override {
        body_ = body;
        push_.assign(mesh_.canopy_nodes, {splat(0.0)});
        step_ = {};
        acts_.clear();
        fabric_.clear();
        edges_ = pairs_ = tapes_ = lines_ = risers_ = cords_ = {};
        pulled_.clear();
        line_damping_ = 0.0;
        has_ = {};
        air_ = AirOnFabric::none;
        springs_ = {};
        first_aero_ = constants_.canopy_nodes;
        structure_ = &structure;
        for (const ForceModels* models : {&structure, &loads})
            for (const auto& model : *models) {
                const auto row = std::ranges::find(rows, model->block(), &Row::block);
                const bool has_row = row != rows.end();
                acts_.push_back({has_row ? row->add : nullptr, model.get(), model->node_load()});
                if (has_row)
                    (this->*row->prepare)();
                else if (models == &loads && !model->node_load())
                    first_aero_ = std::min(first_aero_, model->first_node());
            }
        if (springs_.springs || springs_.folds) prepare_edges();
        clear_forces(state);
        // Most nodes of the canopy know pressure alone. Those on lines take their part of it before
        // subcycles.
        first_held_aero_ = pulled_.empty() ? first_aero_ : std::min(first_aero_, pulled_.front());
        state.aero.clear(state.node.size(), static_cast<std::size_t>(first_held_aero_));
        weights_.begin(state, constants_, structure, find_block(structure, Block::lines));
    }

    void store(State&) const override {}

    std::vector<PlanArray> arrays() const override {
        std::vector<PlanArray> all;
        // Canopy pressure, fabric drag and membranes read the same constants of triangles, springs and fold
        // resistance those of edges.
        for (const Sheet& sheet : fabric_)
            for (const unstructured::ElementList& list : sheet.lists)
                add_bytes(all, "triangles", list.bytes());
        add_bytes(all, "edges", edges_.bytes());
        add_bytes(all, "gore contact", pairs_.bytes());
        add_bytes(all, "tapes", tapes_.bytes());
        add_bytes(all, "lines", lines_.bytes() + risers_.bytes() + bytes_of(pulled_));
        add_bytes(all, "static line", cords_.bytes());
        add_bytes(all, "lines", bytes_of(others_) + bytes_of(inverse_inertia_));
        add_bytes(all, "pushed areas", bytes_of(push_));
        for (const GershgorinSums* sums : {&sums_, &pulled_sums_})
            add_bytes(all, "bound on the step",
                      bytes_of(sums->stiffness) + bytes_of(sums->damping) + bytes_of(sums->weight));
        return all;
    }

    double membrane_energy(State& state) const override { return membrane_levels(state).energy; }

    EnergiesAndStrains levels(const State& state) const override {
        EnergiesAndStrains levels{kinetic_energy(state, constants_), 0.0, {}};
        for (const auto& model : *structure_) {
            const bool is_membrane = model->block() == Block::membrane;
            EnergyAndStrain of_block =
                is_membrane ? membrane_levels(state)
                            : EnergyAndStrain{model->energy(state), model->extreme(state).strain};
            if (is_membrane) of_block.energy *= state.fe_weight, of_block.strain *= state.fe_weight;
            levels.elastic += of_block.energy;
            levels.strain.push_back(of_block.strain);
        }
        return levels;
    }
    double fabric_strain(const State& state) const override { return fabric_strain_of(state, *structure_); }

    void evaluate(State& state, BlockClock& clock) override {
        if (shared_ > 0.0) tuner_.took(std::exchange(shared_, 0.0));
        node_loads_ = {};
        step_.contact = {};
        for (std::size_t k = 0; k < acts_.size(); ++k) {
            if (k == structure_->size()) note_riser_force(state, mesh_.payload());
            const Acting& block = acts_[k];
            clock.run([&] {
                if (block.load) return block.load->add_to(node_loads_, state);
                // Blocks that act on a few nodes have no kernel.
                block.add ? (this->*block.add)(state) : block.model->add_forces(state);
            });
        }
        if (acts_.size() == structure_->size()) note_riser_force(state, mesh_.payload());
    }

    CriticalSteps critical_steps(const State& state) override {
        weights_.renew(state);
        GershgorinSums& sums = cleared(sums_, state);
        sums.weight = weights_.by_node();
        const unstructured::Rows rows_out = rows_of(sums);
        const unstructured::Nodes nodes = nodes_to_read(state);
        for (Sheet& sheet : fabric_)
            sheet.pass.weight = state.fe_weight;
        if (has_.membrane)
            for_lists([&](std::size_t k) {
                for (const Sheet& sheet : fabric_)
                    kernels_.membrane_rows(nodes, sheet.lists[k].elements(), sheet.pass, rows_out);
            });
        if (springs_.springs || springs_.folds)
            kernels_.spring_rows(nodes, edges_.elements(), springs_of(state), rows_out);
        if (!state.folded) kernels_.cable_rows(tapes_.elements(), rows_out);
        kernels_.cable_rows(cords_.elements(), rows_out);
        for (const Acting& block : acts_)
            if ((!block.add && !block.load) || block.add == &UnstructuredLayout::add_contacts)
                block.model->add_row_sums(state, sums);

        GershgorinSums& pulled = cleared(pulled_sums_, state);
        pulled.weight.assign(state.node.size(), 1.0);
        unstructured::Bound bound{constants_.mass, constants_.share, state.added_mass};
        NodeLoads loads;
        for (const Acting& block : acts_)
            if (block.load) block.load->add_to(loads, state);
        bound.by_share = loads.damping_by_share();
        bound.by_mass = loads.mass_damping;
        CriticalSteps steps;
        // Nodes on lines that are not of the canopy are held by lines alone.
        unstructured::Bound canopy = bound;
        canopy.mass = canopy.mass.first(static_cast<std::size_t>(constants_.canopy_nodes));
        canopy.share = canopy.share.first(canopy.mass.size());
        steps.canopy = std::min(kernels_.critical_step(rows_out, canopy), stable_step_of_static_line(sums));
        if (!has_.lines) return {steps.canopy, steps.canopy, steps.canopy};
        add_rows_of_lines(pulled);
        steps.lines = std::numeric_limits<double>::infinity();
        const auto step_of = [&](const GershgorinSums& of, NodeIndex i, double damping) {
            const double inertia = constants_.mass[i] + constants_.share[i] * state.added_mass;
            return critical_step_of(of.stiffness[i], of.damping[i] + damping, inertia);
        };
        for (const NodeIndex i : pulled_) {
            const double damping =
                mesh_.is_canopy(i) ? 0.0 : sums.damping[i] + bound.by_mass * constants_.mass[i];
            steps.lines = std::min(steps.lines, step_of(pulled, i, damping));
            // Contact acts once a step, whatever lines do within it.
            if (!mesh_.is_canopy(i) && sums.stiffness[i] > 0.0)
                steps.canopy = std::min(steps.canopy, step_of(sums, i, bound.by_mass * constants_.mass[i]));
        }
        auto next = std::ranges::lower_bound(pulled_, constants_.canopy_nodes);
        for (NodeIndex i = constants_.canopy_nodes; i < mesh_.node_count(); ++i)
            if (next != pulled_.end() && *next == i)
                ++next;
            else
                steps.canopy = std::min(steps.canopy, step_of(sums, i, bound.by_mass * constants_.mass[i]));
        add_rows_of_lines(sums);
        steps.all = std::min(kernels_.critical_step(rows_out, bound), stable_step_of_static_line(sums));
        return steps;
    }

    void accelerate(const Vec3& acceleration) override {
        for (std::size_t c = 0; c < 3; ++c)
            step_.contact[c] += acceleration[static_cast<int>(c)];
    }
    void impulse(State& state) override {
        NodeMover mover(state, constants_, dt_);
        step_.record = doubles(state.node);
        step_.v_half = doubles(state.v_half);
        step_.mass = constants_.mass;
        step_.share = constants_.share;
        step_.canopy = static_cast<std::size_t>(constants_.canopy_nodes);
        step_.first_aero = static_cast<std::size_t>(first_aero_);
        step_.added_mass = state.added_mass;
        step_.kick = mover.kick();
        step_.dt = dt_;
        step_.weighs = state.energy.weighs;
        step_.last_dt = state.dt;
        step_.gravity = constants_.gravity;
        step_.on_fabric = to_array4(node_loads_.on_fabric);
        step_.breathing = node_loads_.breathing;
        step_.canopy_mean = to_array4(node_loads_.canopy_mean);
        step_.accretion = node_loads_.accretion;
        step_.wind = to_array4(node_loads_.wind);
        step_.mass_damping = node_loads_.mass_damping;
        step_.system_mean = to_array4(node_loads_.system_mean);
        StepSums& sums = step_sums_;
        if (together()) {
            state.damping_power += line_damping_;
            move_all(state, sums);
            if (body_) body_->advance(state, mover.kick(), dt_);
        } else {
            move_all(state, sums);
            const double first_kick = subcycle(state, dt_, subcycles_, 0).kick;
            inverse_inertia_.resize(pulled_.size());
            for (std::size_t k = 0; k < pulled_.size(); ++k) {
                const NodeIndex i = pulled_[k];
                inverse_inertia_[k] = 1.0 / (constants_.mass[i] + constants_.share[i] * state.added_mass);
            }
            for (std::size_t k = 0; k < pulled_of_canopy(); ++k) {
                const NodeIndex i = pulled_[k];
                const Lanes force = others_[k].value + damp_and_push(state, i);
                const Lanes middle = mover.kick_alone(i, force, constants_.mass[i], 1.0 / inverse_inertia_[k],
                                                      first_kick, sums);
                sums.share_square += constants_.share[i] * sum3(middle * middle);
            }
            add(kernels_.kick(nodes_of(state), step_, pulled_lines(), first_kick, state.line_dt), state,
                sums);
            if (body_) body_->impulse(state, mover.kick());
        }
        mover.move_static_line(constants_, sums);
    }
    void pull(State& state, int) override {
        line_damping_ = pull_lines(state);
        state.in_subcycles.add(state.force[mesh_.payload()].value);
    }
    void drift(State& state, int k) override {
        const Subcycle step = subcycle(state, dt_, subcycles_, k);
        step_sums_.line_damping += step.kick * line_damping_;
        kernels_.subcycle(nodes_of(state), pulled(), step.kick, step.dt);
        if (body_) body_->move(state, step.kick, step.dt);
    }
    void end_step(State& state, double next_added_mass) override {
        NodeMover mover(state, constants_, dt_);
        if (!together()) {
            step_sums_.line_damping_power = line_damping_ / subcycles_;
            for (std::size_t k = 0; k < pulled_of_canopy(); ++k) {
                mover.end_subcycles(pulled_[k]);
                mover.add_canopy(pulled_[k], constants_, step_sums_);
            }
            add(kernels_.end_subcycles(nodes_of(state), pulled_lines(), dt_, constants_.mass), state,
                step_sums_);
            if (body_) body_->finish(state, dt_);
        }
        finish_step(state, constants_, step_sums_, mover.kick(), dt_, dt_ / subcycles_, next_added_mass);
    }

    void serialize(Archive& archive, const State&) override {
        archive.numbers("pushed areas",
                        std::span(doubles(push_), sizeof(Lanes) / sizeof(double) * push_.size()));
        weights_.serialize(archive);
    }

private:
    /// How a block of the registry acts through kernels.
    struct Row {
        Block block;
        void (UnstructuredLayout::*prepare)();
        void (UnstructuredLayout::*add)(State&);
    };
    static const std::array<Row, 10> rows;

    struct Acting {
        void (UnstructuredLayout::*add)(State&);
        const ForceModel* model;
        const NodeLoad* load;
    };
    struct Has {
        bool membrane = false, fabric = false, lines = false, line_drag = false;
    };

    const Deployment& deploy() const { return scene_.parachutes.front().deploy; }

    unstructured::Nodes nodes_of(State& state) {
        return {doubles(state.node), doubles(state.force.held()),
                reinterpret_cast<double*>(&state.aero.view()[0]),  // where that would be
                doubles(push_)};
    }
    static GershgorinSums& cleared(GershgorinSums& sums, const State& state) {
        sums.stiffness.assign(state.node.size(), 0.0);
        sums.damping.assign(state.node.size(), 0.0);
        return sums;
    }
    static unstructured::Rows rows_of(GershgorinSums& sums) {
        return {sums.stiffness.data(), sums.damping.data(), sums.weight.data()};
    }
    static unstructured::Nodes nodes_to_read(const State& state) {
        return {reinterpret_cast<const double*>(state.node.data()), nullptr, nullptr, nullptr};
    }

    /// [s] of the static line, which is not of the system; its anchor is not accelerated.
    double stable_step_of_static_line(const GershgorinSums& sums) const {
        double least = std::numeric_limits<double>::infinity();
        const std::vector<double>& mass = constants_.static_line_mass;
        const std::size_t first = constants_.first_static_line();
        for (std::size_t k = 0; k + 1 < mass.size(); ++k)
            least = std::min(least,
                             critical_step_of(sums.stiffness[first + k], sums.damping[first + k], mass[k]));
        return least;
    }

    // --- node update ---------------------------------------------------------------------

    /// All but those that take subcycles, if they do now.
    void move_all(State& state, StepSums& sums) {
        const unstructured::Nodes nodes = nodes_of(state);
        moved_.front() = {sums, state.damping_power, state.accretion_power};
        share(parts_.count(), [&](std::size_t k) {
            const bool is_last = k + 1 == parts_.count();  // which has what is not of the canopy
            std::size_t next = k > 0 ? static_cast<std::size_t>(parts_.end(k - 1)) : 0;
            const std::size_t end =
                is_last ? constants_.mass.size() : static_cast<std::size_t>(parts_.end(k));
            Moved moved = k > 0 ? Moved{} : moved_[k];
            unstructured::Advance step = step_;
            const auto move_to = [&](std::size_t last) {
                step.first = std::exchange(next, last + 1), step.last = last;
                if (step.first < last) moved.add(kernels_.advance(nodes, step));
            };
            if (!together())
                for (auto i = std::ranges::lower_bound(pulled_, static_cast<NodeIndex>(next));
                     i != pulled_.end() && static_cast<std::size_t>(*i) < end; ++i)
                    move_to(static_cast<std::size_t>(*i));
            move_to(end);
            moved_[k] = moved;
        });
        for (std::size_t k = 1; k < moved_.size(); ++k)
            moved_.front() += moved_[k];
        sums = moved_.front().sums;
        state.damping_power = moved_.front().damping_power;
        state.accretion_power = moved_.front().accretion_power;
    }
    static void add(const unstructured::Sums& s, State& state, StepSums& sums) {
        Moved moved{sums, state.damping_power, state.accretion_power};
        moved.add(s);
        sums = moved.sums;
        state.damping_power = moved.damping_power;
        state.accretion_power = moved.accretion_power;
    }

    /// Number of nodes in subcycles that are of the canopy; they come first.
    std::size_t pulled_of_canopy() const {
        return static_cast<std::size_t>(std::ranges::lower_bound(pulled_, constants_.canopy_nodes) -
                                        pulled_.begin());
    }
    unstructured::Subcycled pulled() {
        return {pulled_, inverse_inertia_, doubles(others_), step_.record, step_.v_half};
    }
    /// Nodes in subcycles outside the canopy.
    unstructured::Subcycled pulled_lines() {
        unstructured::Subcycled lines = pulled();
        lines.node = lines.node.subspan(pulled_of_canopy());
        lines.inverse_inertia = lines.inverse_inertia.subspan(pulled_of_canopy());
        lines.others += 4 * pulled_of_canopy();
        return lines;
    }
    /// Nodes on lines and risers: line pulls at the time of the forces are evaluated once more, alone.
    void separate(State& state) override {
        const NodeForces::View pull = state.force.view();
        for (std::size_t k = 0; k < pulled_.size(); ++k)
            others_[k].value = std::exchange(pull[pulled_[k]].value, splat(0.0));
        const NodeForces::View aero = state.aero.view();
        const auto first = static_cast<std::size_t>(mesh_.first_attachment()),
                   last = first + mesh_.attachments.size();
        for (std::size_t i = first; i < last; ++i)
            aero[i].value += std::exchange(pull[i].value, splat(0.0));
        line_damping_ = pull_lines(state);
        for (std::size_t i = first; i < last; ++i)
            aero[i].value -= pull[i].value;
        for (std::size_t k = 0; k < pulled_.size(); ++k)
            others_[k].value -= pull[pulled_[k]].value;
    }
    /// [N] of damping and accretion on one node; pressure and residual drag go to state.aero. What the
    /// kernel's node update does for all others.
    Lanes damp_and_push(State& state, NodeIndex i) {
        const Lanes v = state.node[i].v;
        const double share = constants_.share[i];
        Lanes force = splat(0.0);
        Lanes dissipated = force, accreted = force;
        if (step_.mass_damping > 0.0)
            law::resist(step_.mass_damping * constants_.mass[i], v - as_lanes(step_.system_mean), force,
                        dissipated);
        if (mesh_.is_canopy(i)) {
            force += constants_.mass[i] * as_lanes(step_.contact);
            if (step_.breathing > 0.0)
                law::resist(share * step_.breathing, v - as_lanes(step_.canopy_mean), force, dissipated);
            if (step_.accretion > 0.0)
                law::accrete(share * step_.accretion, as_lanes(step_.wind), v, force, accreted);
            state.aero[i].value += step_.pressure * std::exchange(push_[i].value, splat(0.0)) +
                                   share * as_lanes(step_.on_fabric);
        }
        state.damping_power += sum3(dissipated);
        state.accretion_power += sum3(accreted);
        return force;
    }

    // --- fabric ---------------------------------------------------------------------------

    void prepare_fabric() {
        if (has_.fabric) return;
        has_.fabric = true;
        for (int k = 0; k < mesh_.sheets(); ++k)
            prepare_sheet(k);
    }
    void prepare_sheet(int number) {
        Sheet& sheet = fabric_.emplace_back();
        sheet.pass = {membrane_law(mesh_.fabric_of(number), scene_.full.bulk_viscosity)};
        using Constants = std::array<double, unstructured::membrane_constants>;
        const std::vector<unstructured::Quad> quads = unstructured::quads_of(mesh_, number);
        const auto constants = [&](const Triangle& t) {
            return Constants{1.0 / t.a, 1.0 / t.c, t.b / t.a, t.area(),
                             sheet.pass.law.viscosity * element_length(t)};
        };
        std::vector<std::vector<const unstructured::Quad*>> by_list(parts_.lists());
        for (const unstructured::Quad& quad : quads)
            by_list[parts_.list_of(quad)].push_back(&quad);
        for (const auto& some : by_list) {
            unstructured::ElementList& list = sheet.lists.emplace_back();
            // A triangle of one point does nothing at its node, but it writes there, while others write to
            // theirs: a node of the list's own. (The dummy has no area to be pushed on.)
            const NodeIndex own = some.empty() ? 0 : some.front()->node[0];
            list.begin<4, 2>(some.size(), kernels_.lanes, own, Constants{});
            for (std::size_t i = 0; i < some.size(); ++i) {
                const auto& [node, first, second] = *some[i];
                list.set(i, node, std::array{constants(first), second ? constants(*second) : Constants{}});
            }
        }
    }

    /// Calls work(k) for all k, several at once where there are threads.
    template <class Work>
    void share(std::size_t count, const Work& work) {
        const auto do_all = [&] {
            for (std::size_t k = 0; k < count; ++k)
                work(k);
        };
        if (!threads_) return do_all();
        // The rest of a step, long where it bounds the next or writes results, is the same for any number.
        const auto began = std::chrono::steady_clock::now();
        if (tuner_.now() > 1)
            threads_->share(static_cast<int>(count), [&](int k) { work(static_cast<std::size_t>(k)); });
        else
            do_all();
        shared_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    }
    /// At full stiffness.
    EnergyAndStrain membrane_levels(const State& state) const {
        EnergyAndStrain all{};
        for (const Sheet& sheet : fabric_)
            for (const unstructured::ElementList& list : sheet.lists) {
                const EnergyAndStrain some =
                    kernels_.membrane_levels(nodes_to_read(state), list.elements(), sheet.pass);
                all.energy += some.energy;
                all.strain = std::max(all.strain, some.strain);
            }
        return all;
    }
    /// Calls work(k) for each list of triangles: parts, which share no node, then strips. Sums on nodes are
    /// the same to the last bit for any number of threads.
    template <class Work>
    void for_lists(const Work& work) {
        const std::size_t parts = parts_.count();
        share(parts, work);
        if (parts > 1) share(parts - 1, [&](std::size_t k) { work(parts + k); });
    }
    /// Sums over all triangles. pass(sheet, elements): those of some of a sheet.
    template <class Pass>
    ElementSums over_fabric(const Pass& pass) {
        for_lists([&](std::size_t k) {
            of_list_[k] = {};
            for (const Sheet& sheet : fabric_)
                of_list_[k] += pass(sheet, sheet.lists[k].elements());
        });
        ElementSums sums;
        for (const ElementSums& some : of_list_)
            sums += some;
        return sums;
    }
    void prepare_membrane() {
        has_.membrane = true;
        prepare_fabric();
    }
    void prepare_pressure() {
        air_ = inflow_ ? AirOnFabric::fills : AirOnFabric::pushes;
        prepare_fabric();
    }
    void prepare_fabric_drag() {
        first_aero_ = 0;
        prepare_fabric();
    }

    void use_air(const State& state) {
        for (Sheet& sheet : fabric_) {
            sheet.pass.direction = to_array3(state.air.direction);
            sheet.pass.radial_pressure = state.air.radial_pressure;
            sheet.pass.weight = state.fe_weight;
        }
    }
    /// Membranes, and the areas that pressure acts on with them.
    void add_membrane(State& state) {
        use_air(state);
        fabric_sums_ = over_fabric([nodes = nodes_of(state), run = kernels_.membrane[static_cast<int>(air_)]](
                                       const Sheet& sheet, const unstructured::Elements& some) {
            return run(nodes, some, sheet.pass);
        });
        state.damping_power += fabric_sums_.dissipated;
        state.largest.add_stress(state.fe_weight * fabric_sums_.largest_load);
    }
    void add_pressure(State& state) {
        if (!has_.membrane) {
            use_air(state);
            fabric_sums_ = over_fabric([nodes = nodes_of(state), run = kernels_.air[static_cast<int>(air_)]](
                                           const Sheet& sheet, const unstructured::Elements& some) {
                return run(nodes, some, sheet.pass);
            });
        }
        if (inflow_) {
            const auto edge = [&](std::size_t k) { return state.node[inflow_->edges()[k]]; };
            node_loads_.on_fabric += inflow_->set_pressure(state, fabric_sums_, inflow_->openings(edge));
        } else {
            state.air.projected_area = fabric_sums_.positive_area;
            state.air.signed_area = fabric_sums_.signed_area;
            node_loads_.on_fabric +=
                set_pressure(state.air, smallest_projected_area(scene_.parachutes.front()));
        }
        step_.pressure = state.air.pressure;
    }
    void add_fabric_drag(State& state) {
        const FabricDragPass pass{0.5 * state.air.density * fabric_drag_coefficient(scene_),
                                  to_array3(state.air.wind)};
        const auto drag = [&, nodes = nodes_of(state)](const Sheet&, const unstructured::Elements& some) {
            return kernels_.fabric_drag(nodes, some, pass);
        };
        state.air.projected_area = over_fabric(drag).positive_area;
    }

    void prepare_springs() { springs_.springs = true; }
    void prepare_folds() { springs_.folds = true; }
    void prepare_edges() {
        springs_.repulsion = deploy().compressive_stiffness_ratio;
        const std::vector<FabricEdge> edges = fabric_edges(mesh_);
        using Constants = std::array<double, unstructured::spring_constants>;
        edges_.begin<2>(edges.size(), kernels_.lanes, mesh_.dummy(), Constants{1.0});
        for (std::size_t i = 0; i < edges.size(); ++i) {
            const FabricEdge& e = edges[i];
            const SpringConstants k = fabric_spring_constants(mesh_.fabric_of(e.sheet), e,
                                                              scene_.full.bulk_viscosity, scene_.full.beta);
            edges_.set(i, e.node,
                       Constants{k.inverse_length, k.stiffness, k.dashpot, k.hardening,
                                 fold_force(mesh_.fabric_of(e.sheet), e, deploy().deployment_resistance)});
        }
    }
    SpringPass springs_of(const State& state) const {
        SpringPass pass = springs_;
        pass.folded = state.folded;
        return pass;
    }
    void add_edges(State& state) {
        state.damping_power += kernels_.springs(nodes_of(state), edges_.elements(), springs_).dissipated;
    }
    /// Springs take the folds along: both need the same lengths.
    void add_folds(State& state) {
        if (!springs_.springs) add_edges(state);
    }

    // --- contact --------------------------------------------------------------------------

    void prepare_contacts() {
        using Constants = std::array<double, unstructured::pair_constants>;
        auto pairs = gore_contacts(mesh_);
        std::ranges::stable_sort(pairs, {}, [](const auto& pair) { return std::ranges::min(pair.node); });
        pairs_.begin<2>(pairs.size(), kernels_.lanes, mesh_.dummy(), Constants{});
        for (std::size_t i = 0; i < pairs.size(); ++i)
            pairs_.set(i, pairs[i].node, Constants{pairs[i].stiffness});
    }
    void add_contacts(State& state) {
        const CanopyAxis axis =
            canopy_axis(state.sums.canopy_position, to_vec3(state.node[mesh_.payload()].x));
        const ElementSums sums = kernels_.contacts(nodes_of(state), pairs_.elements(),
                                                   {to_array3(axis.canopy), to_array3(axis.direction)});
        const AxisReaction on = axis_reaction(axis, Vec3(sums.by_arm.data()), Vec3(sums.by_turning.data()));
        step_.contact = to_array4(on.canopy / constants_.canopy_mass);
        state.contact_reaction = on.payload;
        state.force[mesh_.payload()].value += to_lanes(on.payload);
    }

    // --- cables ---------------------------------------------------------------------------

    unstructured::ElementList list_of(const std::vector<Cable>& cables) const {
        using Constants = std::array<double, unstructured::cable_constants>;
        unstructured::ElementList list;
        list.begin<2>(cables.size(), kernels_.lanes, mesh_.dummy(), Constants{1.0});
        for (std::size_t i = 0; i < cables.size(); ++i) {
            const CableConstants k =
                cable_constants(mesh_, cables[i], scene_.full.bulk_viscosity, scene_.full.beta);
            list.set(i, cables[i].node, Constants{1.0 / cables[i].rest_length, k.stiffness, k.dashpot});
        }
        return list;
    }
    std::vector<Cable> cables_of(bool (*which)(CableKind)) const {
        std::vector<Cable> some;
        for (const Cable& c : mesh_.cables)
            if (which(c.kind)) some.push_back(c);
        return some;
    }
    static bool is_line(CableKind kind) { return kind == CableKind::line; }
    static bool is_riser(CableKind kind) { return !is_tape(kind) && !is_line(kind); }

    void prepare_tapes() { tapes_ = list_of(cables_of(is_tape)); }
    void add_tapes(State& state) {
        state.damping_power += kernels_.cables(nodes_of(state), tapes_.elements()).dissipated;
    }

    /// The suspension lines by themselves, since the air acts on them as well.
    void prepare_lines() {
        has_.lines = true;
        lines_ = list_of(cables_of(is_line));
        risers_ = list_of(cables_of(is_riser));
        for (const Cable& c : mesh_.cables)
            if (!is_tape(c.kind)) pulled_.insert(pulled_.end(), c.node.begin(), c.node.end());
        std::erase_if(pulled_, [&](NodeIndex i) { return i > mesh_.payload(); });  // of a body,
        if (body_) pulled_.push_back(mesh_.payload());                             // which pulls there
        std::ranges::sort(pulled_);
        pulled_.erase(std::unique(pulled_.begin(), pulled_.end()), pulled_.end());
        pulled_.shrink_to_fit();
        others_.assign(pulled_.size(), {splat(0.0)});
        inverse_inertia_.assign(pulled_.size(), 0.0);
    }
    bool drag_acts(const State& state) const {
        return has_.line_drag && state.air.density > 0.0;  // no Reynolds number without air
    }
    LineAir line_air(const State& state) const {
        return {&drag_coefficient_, mesh_.cord(CableKind::line).diameter, state.air.density,
                state.air.viscosity, to_array3(state.air.wind)};
    }
    /// And the drag of lines with them.
    void add_lines(State& state) {
        if (!drag_acts(state)) {
            line_damping_ = pull_lines(state);
            return;
        }
        line_damping_ =
            book_lines(state, kernels_.cables_with_drag(nodes_of(state), lines_.elements(), line_air(state)));
    }
    /// Lines and risers; [W] dissipated.
    double pull_lines(State& state) {
        return book_lines(state, kernels_.cables(nodes_of(state), lines_.elements()));
    }
    /// Risers with them.
    double book_lines(State& state, const ElementSums& lines) {
        state.largest.add_tension(lines.largest_load);
        const double risers = kernels_.cables(nodes_of(state), risers_.elements()).dissipated;
        if (body_) body_->pull(state);
        return lines.dissipated + risers;
    }
    void add_rows_of_lines(GershgorinSums& sums) const {
        kernels_.cable_rows(lines_.elements(), rows_of(sums));
        kernels_.cable_rows(risers_.elements(), rows_of(sums));
    }
    void prepare_static_line() { cords_ = list_of(mesh_.static_line.cables); }
    void add_static_line(State& state) {
        state.damping_power += kernels_.cables(nodes_of(state), cords_.elements()).dissipated;
    }
    void prepare_line_drag() {
        has_.line_drag = true;
        if (!has_.lines) lines_ = list_of(cables_of(is_line));
        for (const Cable& c : mesh_.cables)
            if (c.kind == CableKind::line) first_aero_ = std::min({first_aero_, c.node[0], c.node[1]});
    }
    void add_line_drag(State& state) {
        if (!has_.lines && drag_acts(state))
            kernels_.line_drag(nodes_of(state), lines_.elements(), line_air(state));
    }

    /// Triangles of one fabric, by parts and strips.
    struct Sheet {
        MembranePass pass;
        std::vector<unstructured::ElementList> lists;
    };

    /// Sums over nodes that a step has moved.
    struct Moved {
        StepSums sums;
        double damping_power = 0.0, accretion_power = 0.0;  // [W] as State

        void add(const unstructured::Sums& s) {
            sums.canopy_position += as_lanes(s.canopy_position);
            sums.canopy_velocity += as_lanes(s.canopy_velocity);
            sums.other_position += as_lanes(s.other_position);
            sums.other_velocity += as_lanes(s.other_velocity);
            sums.area_velocity += as_lanes(s.area_velocity);
            sums.drag_power += as_lanes(s.drag_power);
            sums.momentum += as_lanes(s.momentum);
            sums.share_square += sum3(as_lanes(s.share_square));
            sums.kinetic += 0.5 * sum3(as_lanes(s.kinetic));
            damping_power += sum3(as_lanes(s.dissipated));
            accretion_power += sum3(as_lanes(s.accretion_power));
        }
        void operator+=(const Moved& other) {
            sums += other.sums;
            damping_power += other.damping_power;
            accretion_power += other.accretion_power;
        }
    };

    const Scene& scene_;
    const Mesh& mesh_;
    const NodeConstants& constants_;
    const unstructured::Kernels& kernels_;
    std::optional<InflowBalance> inflow_;
    AirOnFabric air_ = AirOnFabric::none;

    const ForceModels* structure_ = nullptr;
    std::vector<Acting> acts_;  // all blocks, those of the structure first
    Has has_;
    unstructured::ElementList edges_, pairs_, tapes_, lines_, risers_, cords_;
    std::vector<NodeIndex> pulled_;        // nodes on lines and risers, which may take subcycles
    std::vector<NodeVector> others_;       // [N] on them, of everything but lines and risers
    std::vector<double> inverse_inertia_;  // [1/kg] of them
    GershgorinSums sums_, pulled_sums_;    // of the bound: all, and of lines and risers alone
    double line_damping_ = 0.0;            // [W] by lines and risers
    PerronScaling weights_;
    std::vector<Sheet> fabric_;
    ElementSums fabric_sums_;
    SpringPass springs_;
    CylinderDragTable drag_coefficient_;
    std::vector<NodeVector> push_;   // [m^2] of each canopy node: area over which pressure acts
    NodeIndex first_aero_ = 0;       // canopy nodes before it have no force in state.aero
    NodeIndex first_held_aero_ = 0;  // nor a place there before this one
    NodeLoads node_loads_;           // of the step
    unstructured::Advance step_;

    unstructured::Parts parts_;
    std::vector<ElementSums> of_list_;  // of the fabric
    std::vector<Moved> moved_;          // of each part
    ThreadCountTuner tuner_;
    std::unique_ptr<WorkerPool> threads_;  // if it may be more than one
    double shared_ = 0.0;                  // [s] of the step, in work that threads share
};

const std::array<UnstructuredLayout::Row, 10> UnstructuredLayout::rows{{
    {Block::membrane, &UnstructuredLayout::prepare_membrane, &UnstructuredLayout::add_membrane},
    {Block::fabric_springs, &UnstructuredLayout::prepare_springs, &UnstructuredLayout::add_edges},
    {Block::gore_contact, &UnstructuredLayout::prepare_contacts, &UnstructuredLayout::add_contacts},
    {Block::tapes, &UnstructuredLayout::prepare_tapes, &UnstructuredLayout::add_tapes},
    {Block::lines, &UnstructuredLayout::prepare_lines, &UnstructuredLayout::add_lines},
    {Block::static_line, &UnstructuredLayout::prepare_static_line, &UnstructuredLayout::add_static_line},
    {Block::canopy_pressure, &UnstructuredLayout::prepare_pressure, &UnstructuredLayout::add_pressure},
    {Block::fabric_drag, &UnstructuredLayout::prepare_fabric_drag, &UnstructuredLayout::add_fabric_drag},
    {Block::deployment_resistance, &UnstructuredLayout::prepare_folds, &UnstructuredLayout::add_folds},
    {Block::line_drag, &UnstructuredLayout::prepare_line_drag, &UnstructuredLayout::add_line_drag},
}};

}  // namespace

std::unique_ptr<Layout> make_unstructured_layout(const Scene& scene, const Mesh& mesh,
                                                 const NodeConstants& constants,
                                                 const unstructured::Kernels* kernels, int threads) {
    return std::make_unique<UnstructuredLayout>(
        scene, mesh, constants, kernels ? *kernels : unstructured::all_kernels().front(), threads);
}

}  // namespace twinchute::fullsim
