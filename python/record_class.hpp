// A record of a run, with what Python makes of it.
#pragma once

#include <memory>
#include <string>

#include "lib/record/frames.hpp"
#include "lib/record/run_record.hpp"
#include "python/convert.hpp"

namespace twinchute::python {

struct RecordObject {
    std::shared_ptr<const RunRecord> record;
    std::shared_ptr<const ShapeFrames> frames = {};  ///< null: none
    py::object metrics = {};                         ///< once they were asked for
};

void bind_record(py::module_& module);

}  // namespace twinchute::python
