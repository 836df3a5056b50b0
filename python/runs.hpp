// Runs of both models, and long work that Python watches.
#pragma once

#include <functional>
#include <stop_token>

#include "lib/solve/fidelity.hpp"
#include "python/convert.hpp"

namespace twinchute::python {

/// Long work as it sees its watcher.
struct Watched {
    std::stop_token stop;
    std::function<void(const Progress&)> progress;  ///< never empty
};

/// Does work on a thread of its own, without the interpreter's lock, while this one looks for Ctrl-C and
/// calls `progress` (None: nothing) with the latest report, twenty times a second. What either raises asks
/// the work to stop, and is thrown once it has. Throws what the work throws.
void watch(const py::object& progress, const std::function<void(const Watched&)>& work);

/// `threads`, or as many as there are processors where it is None. Throws UsageError.
int threads_of(const py::object& threads);

void bind_runs(py::module_& module);

}  // namespace twinchute::python
