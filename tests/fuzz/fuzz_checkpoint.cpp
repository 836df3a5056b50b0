// Any bytes as a checkpoint, as they are and with a sum that fits: a checkpoint that is written as it was
// read, or a RecordError with a place. What a checkpoint holds of a run is parts by name, too: any bytes as
// those.
#include "lib/math/sha256.hpp"
#include "lib/record/archive.hpp"
#include "lib/record/checkpoint.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace twinchute;

void check_place(const RecordError& error) {
    fuzz::require(error.place().file == "d/checkpoint.bin", "an error has a place");
    fuzz::require(*error.what() != '\0', "an error says something");
}

void read(std::string_view bytes) {
    try {
        const Checkpoint checkpoint = read_checkpoint_bytes(bytes, "d/checkpoint.bin");
        fuzz::require(checkpoint_bytes(checkpoint) == bytes, "a checkpoint is written as it was read");
    } catch (const RecordError& error) {
        check_place(error);
    }
}

/// A run's parts of every kind.
struct Parts {
    double number = 0.0;
    std::optional<double> maybe;
    std::vector<double> numbers, some;
    int whole = 0;
    bool flag = false;
    std::string text;
    std::vector<std::uint16_t> small;
    struct Row {
        double a, b;
    };
    std::vector<Row> rows, list;

    void serialize(Archive& archive) {
        archive.flag("f", flag);
        archive.whole("w", whole, -3, 300);
        archive.number("n", number);
        archive.number("m", maybe);
        archive.numbers("v", numbers, 100);
        archive.text("t", text);
        archive.small("s", small);
        archive.rows("r", rows, [](Row& row, auto&& each) { each(row.a), each(row.b); });
        archive.length("l", list, 1000);
        for (Row& row : list)
            archive.number("a", row.a);
    }
};

void read_parts(std::string_view bytes) {
    Parts parts;
    try {
        Archive archive(bytes, "d/checkpoint.bin");
        parts.serialize(archive);
        archive.end();
    } catch (const RecordError& error) {
        return check_place(error);
    }
    Archive again;
    parts.serialize(again);
    fuzz::require(again.take() == bytes, "parts are written as they were read");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view bytes = fuzz::text_of(data, size);
    read(bytes);
    read_parts(bytes);
    const std::string with_head = "twinchute checkpoint 1\n" + std::string(bytes);
    read(with_head + sha256_hex(with_head));
    return 0;
}
