#include "fullsim/storage/gore_batched/gore_self_contact.hpp"

namespace twinchute::fullsim {
namespace {

/// Bounds on the step and balances of energy come at multiples of it. Where they come at others, too, they
/// pay for a state of their own.
constexpr std::int64_t steps_between_levels = 10;

/// x, y, z and weight.
Eigen::Vector4d looked_at(const SelfContactState& contact, NodeIndex i) {
    const std::size_t count = contact.looked_at.size() / 4;
    const double* x = &contact.looked_at[static_cast<std::size_t>(i)];
    return {x[0], x[count], x[2 * count], x[3 * count]};
}

}  // namespace

GoreSelfContact::GoreSelfContact(const SelfContact& model, const Gores& gores, const GoreNodes& nodes,
                                 const GoreKernels& kernels, NodeIndex payload)
    : model_(model),
      gores_(gores),
      nodes_(nodes),
      kernels_(kernels),
      payload_(payload),
      all_(nodes.own_nodes()) {}

void GoreSelfContact::push(State& state) {
    const bool sleeps = !looked_at_.empty() && model_.sleeps_on(state, strayed_squared(state));
    const bool of_all = !sleeps || state.step % steps_between_levels == 0;
    nodes_.store_places(state, of_all ? all_ : awake_);
    if (of_all) stored_at_ = state.step;
    if (sleeps) {
        model_.push_awake(state);
    } else {
        model_.add_forces(state);
        note_look(state.contact);
    }
    nodes_.scatter_add_contact(state, awake_, on_lines_);
}

void GoreSelfContact::add_row_sums(const State& state, GershgorinSums& sums) const {
    model_.add_row_sums(with_places(state), sums);
}

double GoreSelfContact::energy(const State& state) const {
    return model_.energy(with_places(state));
}

/// As SelfContact::sleeps_on asks.
double GoreSelfContact::strayed_squared(const State& state) const {
    const LinearMotion motion = SelfContact::motion(state);
    double most = kernels_.farthest(nodes_.frame, looked_at_.data(), motion);
    for (const NodeIndex i : gores_.global) {
        if (i >= payload_) continue;
        const Eigen::Vector4d then = looked_at(state.contact, i);
        const Vec3 strayed = then.w() * (to_vec3(state.node[i].x) - motion.place_of(then.head<3>()));
        // A node that is nowhere counts.
        if (const double squared = strayed.squaredNorm(); !(squared <= most)) most = squared;
    }
    return most;
}

void GoreSelfContact::note_look(const SelfContactState& contact) {
    std::vector<bool> marks(static_cast<std::size_t>(payload_) + 1, false);
    model_.mark_awake_nodes(contact, marks);
    awake_ = nodes_.own_nodes(&marks);
    const GoreFrame& frame = nodes_.frame;
    const auto lanes = static_cast<std::size_t>(frame.lanes);
    looked_at_.resize(static_cast<std::size_t>(frame.blocks) * frame.own * 4 * lanes);
    for (const auto& [i, n, gore, at] : all_) {
        const Eigen::Vector4d then = looked_at(contact, i);
        const std::size_t row = static_cast<std::size_t>(gore / frame.lanes) * frame.own + n;
        double* to = &looked_at_[row * 4 * lanes + static_cast<std::size_t>(gore % frame.lanes)];
        for (std::size_t c = 0; c < 4; ++c)
            to[c * lanes] = then[static_cast<Eigen::Index>(c)];
    }
}

/// The state itself where the records of its nodes are those of now.
const State& GoreSelfContact::with_places(const State& state) const {
    if (stored_at_ == state.step) return state;
    stored_ = std::make_unique<State>(state);
    nodes_.store(*stored_);
    return *stored_;
}

}  // namespace twinchute::fullsim
