// The compiled part of the Python package.
#include "lib/record/run_record.hpp"
#include "python/errors.hpp"
#include "python/record_class.hpp"
#include "python/runs.hpp"
#include "python/scene_class.hpp"
#include "python/studies.hpp"

PYBIND11_MODULE(_core, module) {
    using namespace twinchute::python;
    module.doc() = "Compiled part of twinchute; import twinchute instead.";
    module.attr("__version__") = twinchute::current_provenance().version;
    translate_errors();
    bind_scene(module);
    bind_record(module);
    bind_runs(module);
    bind_studies(module);
}
