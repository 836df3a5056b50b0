#include "lib/scene/waits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace twinchute {
namespace {

/// Event of a parachute that something waits for.
struct WaitingEvent {
    enum class Kind { line_stretch, disreef, full_open, cut };
    std::size_t parachute = 0;
    Kind kind = Kind::line_stretch;
    std::size_t stage = 0;  ///< whose reefing line is cut

    bool operator==(const WaitingEvent&) const = default;
};

using Kind = WaitingEvent::Kind;
using Path = std::vector<WaitingEvent>;

class Waits {
public:
    explicit Waits(const Scene& scene) : scene_(scene) {}

    std::optional<HopelessWait> hopeless() const {
        for (const WaitingEvent& h : all())
            if (auto found = in_a_circle(h)) return found;
        for (const WaitingEvent& h : all())
            if (auto found = never_met(h)) return found;
        for (const WaitingEvent& h : all())
            if (auto found = after_its_cut(h)) return found;
        return {};
    }

private:
    const Parachute& chute(const WaitingEvent& h) const { return scene_.parachutes[h.parachute]; }

    /// Events with a trigger, in the order of the scene.
    std::vector<WaitingEvent> all() const {
        std::vector<WaitingEvent> list;
        for (std::size_t k = 0; k < scene_.parachutes.size(); ++k) {
            list.push_back({k, Kind::line_stretch});
            for (std::size_t i = 0; i < scene_.parachutes[k].reefing.size(); ++i)
                list.push_back({k, Kind::disreef, i});
            list.push_back({k, Kind::cut});
        }
        std::erase_if(list, [this](const WaitingEvent& h) { return trigger(h) == nullptr; });
        return list;
    }

    const Trigger* trigger(const WaitingEvent& h) const {
        const Parachute& p = chute(h);
        switch (h.kind) {
            case Kind::line_stretch:
                return p.deploy_when ? &*p.deploy_when : nullptr;
            case Kind::disreef:
                return &p.reefing[h.stage].until;
            case Kind::cut:
                return p.cut ? &*p.cut : nullptr;
            case Kind::full_open:
                break;
        }
        return nullptr;
    }

    std::string name(const WaitingEvent& h) const {
        switch (h.kind) {
            case Kind::line_stretch:
                return chute(h).name + ".line-stretch";
            case Kind::disreef:
                return fmt::format("{}.reefing.{}", chute(h).name, h.stage + 1);
            case Kind::full_open:
                return chute(h).name + ".full-open";
            case Kind::cut:
                break;
        }
        return chute(h).name + ".cut";
    }

    /// Event that the trigger of `h` is about; none where it is about the flight, or about the reefed stage
    /// that it ends itself.
    std::optional<WaitingEvent> awaited(const WaitingEvent& h) const {
        const Trigger* t = trigger(h);
        if (t == nullptr || (h.kind == Kind::disreef && t->of.empty() && t->kind == Trigger::Kind::full_open))
            return {};
        const auto of = std::ranges::find(scene_.parachutes, t->of, &Parachute::name);
        const std::size_t k = t->of.empty() || of == scene_.parachutes.end()
                                  ? h.parachute
                                  : static_cast<std::size_t>(of - scene_.parachutes.begin());
        switch (t->kind) {
            case Trigger::Kind::line_stretch:
                return WaitingEvent{k, Kind::line_stretch};
            case Trigger::Kind::full_open:
                return WaitingEvent{k, Kind::full_open};
            case Trigger::Kind::cut:
                return WaitingEvent{k, Kind::cut};
            default:
                return {};
        }
    }

    /// Everything that has to have happened before `h`: by its trigger, and to the parachute itself.
    Path before(const WaitingEvent& h) const {
        Path needed;
        if (const auto other = awaited(h)) needed.push_back(*other);
        const std::size_t stages = chute(h).reefing.size();
        const std::size_t done = h.kind == Kind::disreef ? h.stage : h.kind == Kind::full_open ? stages : 0;
        if (done > 0)
            needed.push_back({h.parachute, Kind::disreef, done - 1});
        else if (h.kind != Kind::line_stretch)
            needed.push_back({h.parachute, Kind::line_stretch});
        return needed;
    }

    /// A way from `from` back to `to`, both included; empty where there is none.
    Path way(const WaitingEvent& from, const WaitingEvent& to, Path& seen) const {
        for (const WaitingEvent& next : before(from)) {
            if (next == to) return {from, to};
            if (std::ranges::find(seen, next) != seen.end()) continue;
            seen.push_back(next);
            Path rest = way(next, to, seen);
            if (rest.empty()) continue;
            rest.insert(rest.begin(), from);
            return rest;
        }
        return {};
    }

    /// "main.full-open waits for main.line-stretch, main.line-stretch for drogue.cut"
    std::string words(const Path& way) const {
        std::string text;
        for (std::size_t i = 0; i + 1 < way.size(); ++i)
            text += fmt::format("{}{} {} {}", i > 0 ? ", " : "", name(way[i]), i > 0 ? "for" : "waits for",
                                name(way[i + 1]));
        return text;
    }

    HopelessWait wait(const WaitingEvent& h, std::string problem, std::string why, std::string hint) const {
        std::string table = h.kind == Kind::line_stretch ? "parachute.deploy.when" : "parachute.cut";
        if (h.kind == Kind::disreef) table = fmt::format("parachute.reefing.{}.until", h.stage + 1);
        return {h.parachute, std::move(table), std::move(problem), std::move(why), std::move(hint)};
    }

    std::optional<HopelessWait> never_met(const WaitingEvent& h) const {
        const Trigger& t = *trigger(h);
        const double ground = scene_.environment.ground;
        if (t.kind == Trigger::Kind::altitude && t.value < ground)
            return wait(h, "lies below the ground", fmt::format("{} m, ground {} m", t.value, ground),
                        "give an altitude above it");
        const auto other = awaited(h);
        if (!other || other->kind != Kind::cut || chute(*other).cut) return {};
        return wait(h, fmt::format("'{}' is never cut", chute(*other).name),
                    fmt::format("{} waits for {}", name(h), name(*other)),
                    "give that parachute a cut, or wait for its line-stretch or full-open");
    }

    std::optional<HopelessWait> in_a_circle(const WaitingEvent& h) const {
        Path seen;
        const Path circle = way(h, h, seen);
        if (circle.empty()) return {};
        const bool alone = std::ranges::all_of(
            circle, [&](const WaitingEvent& other) { return other.parachute == h.parachute; });
        return wait(h, alone ? "a parachute waits for itself" : "parachutes wait for each other",
                    words(circle) + ": none of it would ever happen",
                    "let one of them wait for a time, a height or something outside of this circle");
    }

    /// A canopy that has been let go opens no further.
    std::optional<HopelessWait> after_its_cut(const WaitingEvent& h) const {
        if (h.kind != Kind::disreef) return {};
        Path seen;
        const Path from_cut = way(h, {h.parachute, Kind::cut}, seen);
        if (from_cut.empty()) return {};
        return wait(h, "the reefing line would be cut after the parachute itself", words(from_cut),
                    "let it wait for something before that");
    }

    const Scene& scene_;
};

}  // namespace

std::optional<HopelessWait> find_hopeless_wait(const Scene& scene) {
    return Waits(scene).hopeless();
}

}  // namespace twinchute
