#include "fullsim/free_flight.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "fullsim/attitude.hpp"
#include "fullsim/mesh/attach_payload.hpp"
#include "fullsim/mesh/start.hpp"
#include "fullsim/rigid_body.hpp"
#include "lib/scene/line_stretch.hpp"
#include "lib/solve/sundials.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double tolerance = 1e-10;  // relative, and of metres, metres per second and a quaternion

Vec3 vector_at(std::span<const double> y, std::size_t first) {
    return {y[first], y[first + 1], y[first + 2]};
}

}  // namespace

PayloadFlight released_payload(const Scene& scene) {
    double mass = scene.payload.mass;
    for (const Parachute& chute : scene.parachutes)
        mass += chute.count * chute.mass;
    const Vec3 position(0.0, 0.0, scene.release.altitude), velocity = velocity_over_ground(scene.release);
    PayloadFlight payload{0.0, position, velocity, mass};
    if (moments_of_payload(scene)) {
        const Eigen::Quaterniond turn(frame_along(start_axis(scene)));
        payload.body = BodyState{attitude_of(turn)};
    }
    payload.acceleration = free_acceleration(scene, payload);
    return payload;
}

Vec3 free_acceleration(const Scene& scene, const PayloadFlight& payload) {
    Vec3 acceleration = -scene.environment.gravity * Vec3::UnitZ();
    if (!scene.payload.drag_area) return acceleration;
    const double altitude = payload.position.z();
    Vec3 airspeed = payload.velocity;
    if (scene.environment.wind) airspeed -= scene.environment.wind->at(altitude);
    double drag_area = *scene.payload.drag_area;
    if (const auto& table = scene.payload.drag_area_table; table && payload.body)
        drag_area = table->drag_area(attitude_in_air(body_axis(*payload.body), airspeed));
    const double density = scene.environment.atmosphere.at(altitude).density;
    return acceleration - 0.5 * density * drag_area / payload.mass * airspeed.norm() * airspeed;
}

PayloadFlight fly_free(const Scene& scene, const PayloadFlight& from, double end, const FlightWatch& watch) {
    std::vector<double> start;
    for (const Vec3* vector : {&from.position, &from.velocity})
        start.insert(start.end(), vector->begin(), vector->end());
    std::optional<RigidBody> body;
    if (from.body) {
        start.insert(start.end(), from.body->attitude.begin(), from.body->attitude.end());
        body.emplace(BodyNodes{}, from.mass, moments_of_payload(scene).value(), std::vector<Vec3>{});
    }
    const auto flight_at = [&](double t, std::span<const double> y) {
        PayloadFlight now = from;
        now.time = t;
        now.position = vector_at(y, 0);
        now.velocity = vector_at(y, 3);
        if (now.body) {
            const Eigen::Vector4d turn = Eigen::Map<const Eigen::Vector4d>(y.data() + 6).normalized();
            std::ranges::copy(turn, now.body->attitude.begin());
        }
        now.acceleration = free_acceleration(scene, now);
        return now;
    };
    OdeSolver solver(
        explicit_methods().front(),
        [&](double t, std::span<const double> y, std::span<double> rates) {
            const PayloadFlight now = flight_at(t, y);
            std::ranges::copy(now.velocity, rates.begin());
            std::ranges::copy(now.acceleration, rates.begin() + 3);
            if (!now.body) return;
            // dq/dt = 1/2 (0, spin) q, with the angular momentum that nothing changes.
            const Vec3 spin = 0.5 * body->spin_of(*now.body);
            const Eigen::Quaterniond rate =
                Eigen::Quaterniond(0.0, spin.x(), spin.y(), spin.z()) * turn_of(now.body->attitude);
            std::ranges::copy(attitude_of(rate), rates.begin() + 6);
        },
        from.time, start, tolerance, std::vector<double>(start.size(), tolerance), from.body ? 0 : 3);
    if (watch)
        solver.watch(static_cast<int>(watch(from).size()),
                     [&](double t, std::span<const double> y, std::span<double> values) {
                         std::ranges::copy(watch(flight_at(t, y)), values.begin());
                     });
    solver.stop_at(end);
    for (;;) {
        switch (solver.advance()) {
            case OdeSolver::Outcome::stepped:
                continue;
            case OdeSolver::Outcome::reached_stop:
            case OdeSolver::Outcome::found_root:
                return flight_at(solver.time(), solver.state());
            case OdeSolver::Outcome::failed:
                throw std::runtime_error(solver.failure());
        }
    }
}

}  // namespace twinchute::fullsim
