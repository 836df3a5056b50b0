// Cost of an element: its loop runs over a number that counts operations, and over a view that counts what is
// read and written.
#pragma once

#include <array>
#include <cstddef>

#include "lib/models/cylinder_drag.hpp"

namespace twinchute::bench {

/// Counts of one element, or of several.
struct Tally {
    double operations = 0.0;  ///< sums and products; a division and a root count as one each
    double words = 0.0;       ///< doubles of nodes that are read or written

    Tally operator-(const Tally& other) const { return {operations - other.operations, words - other.words}; }
    Tally operator+(const Tally& other) const { return {operations + other.operations, words + other.words}; }
    Tally operator*(double factor) const { return {factor * operations, factor * words}; }
};

/// Sum of all counts so far.
inline Tally tally;

/// A number without a value.
struct Counted {
    Counted() = default;
    Counted(double) {}  // constants take part as they stand in the formulas
};
struct CountedMask {};

inline Counted counted() {
    ++tally.operations;
    return {};
}
inline Counted operator+(Counted, Counted) {
    return counted();
}
inline Counted operator-(Counted, Counted) {
    return counted();
}
inline Counted operator*(Counted, Counted) {
    return counted();
}
inline Counted operator/(Counted, Counted) {
    return counted();
}
inline Counted operator-(Counted) {
    return {};
}
inline void operator+=(Counted&, Counted) {
    counted();
}
inline Counted inverse_root(Counted) {
    tally.operations += 2.0;
    return {};
}
inline Counted like(Counted, double) {
    return {};
}
// Comparisons and choices are no arithmetic.
inline CountedMask operator>(Counted, Counted) {
    return {};
}
inline CountedMask operator<(Counted, Counted) {
    return {};
}
inline CountedMask operator<=(Counted, Counted) {
    return {};
}
inline bool any(CountedMask) {
    return true;
}
inline Counted select(CountedMask, Counted, Counted) {
    return {};
}
inline Counted larger(Counted, Counted) {
    return {};
}
inline Counted smaller(Counted, Counted) {
    return {};
}
inline double sum(Counted) {
    return 0.0;
}
inline double nan_greatest(Counted, double) {
    return 0.0;
}
/// A look-up: value, slope and what lies between.
inline Counted between_ends(const CylinderDragTable&, Counted reynolds) {
    return Counted{} + (reynolds - Counted{}) * Counted{};
}

struct Counted3 {
    Counted x, y, z;
};
inline Counted3 operator+(Counted3 a, Counted3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Counted3 operator-(Counted3 a, Counted3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Counted3 operator*(Counted s, Counted3 a) {
    return {s * a.x, s * a.y, s * a.z};
}
inline void operator+=(Counted3& a, Counted3 b) {
    a = a + b;
}
inline Counted dot(Counted3 a, Counted3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Counted3 cross(Counted3 a, Counted3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Elements one after the other, without lanes that pad (see fullsim/elements/membrane.hpp).
template <class Element>
class CountedView {
public:
    using T = Counted;
    using T3 = Counted3;
    using Flow = Counted3;
    static constexpr bool skips = false;

    explicit CountedView(std::size_t elements) : part_{elements} {}

    static Counted all(double) { return {}; }
    static Counted3 all3(const std::array<double, 3>&) { return {}; }
    Flow flow(const std::array<double, 3>&) const { return {}; }
    int first() const { return 0; }
    int last() const { return 1; }

    struct Part {
        std::size_t elements;

        std::size_t size() const { return elements; }
        Element element(std::size_t) const { return {}; }
        Counted live(Counted sum) const { return sum; }
        Counted live_load(Counted load) const { return load; }
        void finish(std::size_t) const {}
        void close() const {}
    };
    const Part& part(int) const { return part_; }

private:
    Part part_;
};

/// Nodes as the gore-batched storage has them: constants of elements stand once for all gores, and are not
/// counted.
class CountedNodes {
protected:
    static Counted3 read() {
        tally.words += 3.0;
        return {};
    }
    static void write(Counted3) { tally.words += 3.0; }
    static void add(Counted3 force) { write(read() + force); }
    static void subtract(Counted3 force) { write(read() - force); }
};

class CountedTriangle : CountedNodes {
public:
    void edges(Counted3& e1, Counted3& e2) const {
        const Counted3 x0 = read();
        e1 = read() - x0, e2 = read() - x0;
    }
    void edges(Counted3& e1, Counted3& e2, Counted3& w1, Counted3& w2) const { edges(e1, e2), edges(w1, w2); }
    void edges_and_mean_velocity(Counted3& e1, Counted3& e2, Counted3& mean) const {
        edges(e1, e2);
        mean = (1.0 / 3.0) * (read() + read() + read());
    }
    Counted inverse_a() const { return {}; }
    Counted inverse_c() const { return {}; }
    Counted b_over_a() const { return {}; }
    Counted weighted_area(double) const { return {}; }
    Counted viscosity() const { return {}; }
    double half() const { return 0.5; }
    void pull(Counted3 first, Counted3 second, Counted3 third) const {
        add(first);
        subtract(second);
        subtract(third);
    }
    void add_push(Counted3 area) const { add(area), add(area), add(area); }
    void add_drag(Counted3 force) const { add_push(force); }
};

/// Tapes and fabric springs.
class CountedSpan : CountedNodes {
public:
    void ends(Counted3& d, Counted3& w) const {
        const Counted3 x0 = read(), v0 = read();
        d = read() - x0, w = read() - v0;
    }
    Counted inverse_length() const { return {}; }
    Counted stiffness() const { return {}; }
    Counted dashpot() const { return {}; }
    Counted hardening() const { return {}; }
    Counted fold_force() const { return {}; }
    Counted counted(Counted load) const { return load; }
    void pull_together(Counted3 force) const { add(force), subtract(force); }
};

/// Lines, node by node: each is read and written once, between two elements.
class CountedLine : CountedNodes {
public:
    void ends(Counted3& d, Counted3& w) const { d = read() - Counted3{}, w = read() - Counted3{}; }
    Counted3 mean_velocity(Counted3) const { return 0.5 * (Counted3{} + Counted3{}); }
    Counted inverse_length() const { return {}; }
    Counted stiffness() const { return {}; }
    Counted dashpot() const { return {}; }
    Counted counted(Counted load) const { return load; }
    void pull_together(Counted3 force) const { write((Counted3{} + force) - force); }
    void add_drag(Counted3 end) const { write(Counted3{} + end); }
};

/// Counts one element, as two less one: what a loop does once drops out. Loop: takes a view of so many
/// elements.
template <class Element, class Loop>
Tally tally_of(Loop&& loop) {
    const auto of = [&](std::size_t elements) {
        const Tally before = tally;
        loop(CountedView<Element>(elements));
        return tally - before;
    };
    return of(2) - of(1);
}

}  // namespace twinchute::bench
