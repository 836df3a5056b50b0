#include "compare/drop_test_option.hpp"

#include "lib/scene/data_files.hpp"

namespace twinchute::compare {

Option drop_test_option() {
    return {"test", "FILE.csv",
            "draw what a test recorded beside both: time since release, and any of " + test_channels()};
}

std::optional<DropTestHistories> test_of(const Arguments& arguments) {
    const auto file = arguments.value("test");
    if (!file) return {};
    return read_test_histories(read_text_file(*file), std::string(*file));
}

}  // namespace twinchute::compare
