#include "fullsim/run/frames.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace twinchute::fullsim {
namespace {

// [bytes] for all frames of a run: those of the C-9 take 14 kB each, those of the finest meshes 600 kB.
constexpr std::size_t most_memory = 24u << 20;
constexpr std::size_t fewest_frames = 8;

double first_principal(const PlaneTensor& a) {
    const double half_difference = 0.5 * (a.xx - a.yy);  // stresses are far from where squares overflow
    return 0.5 * (a.xx + a.yy) + std::sqrt(half_difference * half_difference + a.xy * a.xy);
}

FabricFolds folds_of(FabricState state) {
    switch (state) {
        case FabricState::slack:
            return FabricFolds::slack;
        case FabricState::wrinkled:
            return FabricFolds::wrinkled;
        case FabricState::taut:
            break;
    }
    return FabricFolds::taut;
}

ShapeCableKind shape_kind(CableKind kind) {
    switch (kind) {
        case CableKind::radial:
            return ShapeCableKind::radial;
        case CableKind::skirt:
            return ShapeCableKind::skirt;
        case CableKind::vent:
            return ShapeCableKind::vent;
        case CableKind::line:
            return ShapeCableKind::line;
        case CableKind::riser:
            return ShapeCableKind::riser;
        case CableKind::vent_line:
            return ShapeCableKind::vent_line;
        case CableKind::static_line:
            break;
    }
    return ShapeCableKind::static_line;
}

}  // namespace

FrameRecorder::FrameRecorder(const Mesh& mesh, bool wanted, int sectors)
    : mesh_(mesh),
      law_(membrane_law(mesh.fabric, 0.0)),
      wanted_(wanted),
      most_frames_(0),
      sectors_(static_cast<std::size_t>(sectors)),
      tether_nodes_(mesh.static_line.position.size()),
      next_(std::numeric_limits<double>::infinity()) {
    if (!wanted) return;
    const auto node = [](NodeIndex i) { return static_cast<std::uint32_t>(i); };
    // The dummy has no place in a frame: what comes after it moves up by one.
    // Risers are drawn to the middle of a body.
    const auto moved_up = [&](NodeIndex i) {
        const NodeIndex tether = mesh.first_static_line_node();
        return node(i >= tether ? i - tether + mesh.node_count() : std::min(i, mesh.payload()));
    };
    shape_.nodes = node(mesh.node_count()) + static_cast<std::uint32_t>(tether_nodes_);
    shape_.payload = node(mesh.payload());
    for (const Triangle& t : mesh.triangles)
        shape_.triangles.push_back({node(t.node[0]), node(t.node[1]), node(t.node[2])});
    for (const auto* cables : {&mesh.cables, &mesh.static_line.cables})
        for (const Cable& c : *cables)
            shape_.cables.push_back({{moved_up(c.node[0]), moved_up(c.node[1])}, shape_kind(c.kind)});
    if (tether_nodes_ > 0) apex_ = mesh.static_line.cables.front().node[0];
    most_frames_ = std::max(fewest_frames, most_memory / bytes_per_frame(shape_));
}

void FrameRecorder::begin(double time, const FrameStretch& stretch) {
    if (!wanted_) return;
    stretch_ = {stretch.interval, std::min(stretch.most, most_frames_)};
    begin_ = next_ = time;
    first_ = shape_.frames.size();
    // Frames of an earlier stretch that are not yet accepted are no longer thinned.
}

void FrameRecorder::take(const State& state) {
    if (!shape_.frames.empty() && !(state.time > shape_.frames.back().time)) return;
    place_.clear();
    const auto add = [&](NodeIndex i) {
        for (int k = 0; k < 3; ++k)
            place_.push_back(state.node[i].x[k]);
    };
    for (NodeIndex i = 0; i < mesh_.node_count(); ++i)
        add(i);
    // A static line that has let go is a point at the apex.
    const bool tethered = !mesh_.static_line.cables.empty();
    for (std::size_t k = 0; k < tether_nodes_; ++k)
        add(tethered ? mesh_.first_static_line_node() + static_cast<NodeIndex>(k) : apex_);
    stress_.clear();
    std::vector<FabricFolds> folds;
    folds.reserve(mesh_.triangles.size());
    const std::size_t first_sector = mesh_.triangles.size() / sectors_;
    for (const Triangle& t : std::span(mesh_.triangles).first(first_sector)) {
        FabricState wrinkling{};
        const PlaneTensor stress = membrane_stress(
            law_,
            green_strain(t, {to_vec3(state.node[t.node[0]].x), to_vec3(state.node[t.node[1]].x),
                             to_vec3(state.node[t.node[2]].x)}),
            &wrinkling);
        stress_.push_back(state.fe_weight * first_principal(stress));
        folds.push_back(folds_of(wrinkling));
    }
    for (std::size_t t = first_sector; t < mesh_.triangles.size(); ++t) {
        stress_.push_back(stress_[t - first_sector]);
        folds.push_back(folds[t - first_sector]);
    }
    shape_.frames.push_back(quantised(state.time, place_, stress_, std::move(folds)));
    next_ = begin_ + stretch_.interval * (std::floor((state.time - begin_) / stretch_.interval + 1e-9) + 1.0);
}

void FrameRecorder::accept() {
    auto& frames = shape_.frames;
    while (frames.size() > first_ + stretch_.most) {
        std::size_t kept = first_;
        for (std::size_t i = first_; i < frames.size(); i += 2, ++kept)
            if (kept != i) frames[kept] = std::move(frames[i]);
        frames.resize(kept);
        stretch_.interval *= 2.0;
        next_ = begin_ + stretch_.interval *
                             (std::floor((frames.back().time - begin_) / stretch_.interval + 1e-9) + 1.0);
    }
    accepted_ = frames.size();
}

void FrameRecorder::serialize(Archive& archive) {
    bool wanted = wanted_;
    archive.flag("shapes", wanted);
    if (wanted != wanted_) archive.refuse("is of a run with another output", "shapes for a report, or none");
    archive.number("interval of shapes", stretch_.interval);
    archive.whole("most shapes", stretch_.most);
    archive.number("begin of shapes", begin_);
    archive.number("next shape", next_);
    archive.length("shapes", shape_.frames, 1'000'000);
    archive.whole("shapes before", first_, 0, shape_.frames.size());
    archive.whole("accepted shapes", accepted_, 0, shape_.frames.size());
    for (ShapeFrame& frame : shape_.frames) {
        auto& [time, corner, step, stress_step, place, stress, folds] = frame;
        archive.number("time", time);
        archive.numbers("corner", std::span(corner));
        archive.number("step", step);
        archive.number("stress step", stress_step);
        archive.small("place", place);
        archive.small("stress", stress);
        archive.small("folds", folds);
    }
}

ShapeFrames FrameRecorder::finish() {
    forget();
    next_ = std::numeric_limits<double>::infinity();
    return std::move(shape_);
}

}  // namespace twinchute::fullsim
