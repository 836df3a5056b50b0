#include "lib/record/write_record.hpp"

#include "lib/record/field_files.hpp"
#include "lib/record/record_csv.hpp"
#include "lib/record/record_json.hpp"

namespace twinchute {

void add_record(FileBatch& batch, const RunRecord& record, const std::filesystem::path& directory) {
    remove_old_fields(batch, directory);
    batch.add(directory / "history.csv", history_csv(record));
    batch.add(directory / "events.csv", events_csv(record));
    batch.add(directory / "summary.json", summary_json(record), FileBatch::Kind::marker);
}

void write_record(const RunRecord& record, const std::filesystem::path& directory) {
    FileBatch batch;
    add_record(batch, record, directory);
    batch.commit();
}

}  // namespace twinchute
