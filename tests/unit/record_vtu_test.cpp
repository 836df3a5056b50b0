// Files that VTK reads, byte for byte, and how those of one run replace those of another. The base64 was
// made by Python: base64.b64encode(struct.pack("<Q", bytes) + struct.pack("<9d", ...)).
#include <gtest/gtest.h>

#include <array>
#include <clocale>

#include "lib/record/field_files.hpp"
#include "lib/record/write_record.hpp"
#include "tests/support/scratch_dir.hpp"

namespace twinchute {
namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

/// A triangle, and its last corner as a cell of its own.
VtuGrid small_grid(double time) {
    VtuGrid grid;
    grid.note = "a note";
    grid.time = time;
    grid.points = {0, 0, 0, 1, 0, 0, 0, 1, 300.25};
    grid.add_cell(VtuCell::triangle, std::array{0, 1, 2});
    grid.add_cell(VtuCell::vertex, std::array{2});
    grid.point_data.push_back({"velocity_m_s", 3, std::vector<float>{0, 0, -2, 0, 0, -2, 0.5f, 0, -2}});
    grid.point_data.push_back({"mass_kg", 1, std::vector<double>{1, 2, 3}});
    grid.cell_data.push_back({"a<\"b\"&c", 1, std::vector<float>{0.1f, 0}});
    grid.cell_data.push_back({"state", 1, std::vector<std::int8_t>{2, -1}});
    return grid;
}

constexpr const char* small_text = R"(<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <!-- a note -->
  <UnstructuredGrid>
    <FieldData>
        <DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="binary">
CAAAAAAAAAAAAAAAAADAPw==
        </DataArray>
    </FieldData>
    <Piece NumberOfPoints="3" NumberOfCells="2">
      <PointData>
        <DataArray type="Float32" Name="velocity_m_s" NumberOfComponents="3" format="binary">
JAAAAAAAAAAAAAAAAAAAAAAAAMAAAAAAAAAAAAAAAMAAAAA/AAAAAAAAAMA=
        </DataArray>
        <DataArray type="Float64" Name="mass_kg" NumberOfComponents="1" format="binary">
GAAAAAAAAAAAAAAAAADwPwAAAAAAAABAAAAAAAAACEA=
        </DataArray>
      </PointData>
      <CellData>
        <DataArray type="Float32" Name="a&lt;&quot;b&quot;&amp;c" NumberOfComponents="1" format="binary">
CAAAAAAAAADNzMw9AAAAAA==
        </DataArray>
        <DataArray type="Int8" Name="state" NumberOfComponents="1" format="binary">
AgAAAAAAAAAC/w==
        </DataArray>
      </CellData>
      <Points>
        <DataArray type="Float64" Name="position_m" NumberOfComponents="3" format="binary">
SAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAADwPwAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAPA/AAAAAADEckA=
        </DataArray>
      </Points>
      <Cells>
        <DataArray type="Int32" Name="connectivity" NumberOfComponents="1" format="binary">
EAAAAAAAAAAAAAAAAQAAAAIAAAACAAAA
        </DataArray>
        <DataArray type="Int32" Name="offsets" NumberOfComponents="1" format="binary">
CAAAAAAAAAADAAAABAAAAA==
        </DataArray>
        <DataArray type="UInt8" Name="types" NumberOfComponents="1" format="binary">
AgAAAAAAAAAFAQ==
        </DataArray>
      </Cells>
    </Piece>
  </UnstructuredGrid>
</VTKFile>
)";

TEST(RecordVtu, AGridHasTheseBytes) {
    EXPECT_EQ(vtu_text(small_grid(0.125)), small_text);
}

TEST(RecordVtu, ACollectionHasTheseBytesInAnyLocale) {
    const std::array entries{PvdEntry{0.0, "fields/a.vtu"}, PvdEntry{0.1, "fields/b.vtu"}};
    constexpr const char* expected = R"(<?xml version="1.0"?>
<VTKFile type="Collection" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <Collection>
    <DataSet timestep="0" part="0" file="fields/a.vtu"/>
    <DataSet timestep="0.1" part="0" file="fields/b.vtu"/>
  </Collection>
</VTKFile>
)";
    EXPECT_EQ(pvd_text(entries), expected);
    for (const char* name : {"de_DE.UTF-8", "C.UTF-8"})
        if (std::setlocale(LC_ALL, name) != nullptr) {
            EXPECT_EQ(pvd_text(entries), expected) << name;
        }
    std::setlocale(LC_ALL, "C");
}

TEST(RecordVtu, AnEmptyGridIsAGridToo) {
    const std::string text = vtu_text({});
    EXPECT_NE(text.find("<Piece NumberOfPoints=\"0\" NumberOfCells=\"0\">"), std::string::npos);
    EXPECT_NE(text.find("\nAAAAAAAAAAA=\n"), std::string::npos);  // no bytes
    EXPECT_EQ(text.find("TimeValue"), std::string::npos);
}

class FieldFilesTest : public testing::Test {
protected:
    void write(int frames, bool commit = true) {
        FileBatch batch;
        FieldFiles fields(batch, here_.path());
        for (int i = 0; i < frames; ++i)
            fields.add(small_grid(i));
        fields.finish();
        add_record(batch, {}, here_.path());
        if (commit) batch.commit();
    }
    Names names() const { return tree_of(here_.path()); }

    ScratchDir here_;
    const Names record_{"history.csv", "events.csv", "summary.json"};
};

TEST_F(FieldFilesTest, FramesLieBesideTheirRecordAndTheCollectionNamesThem) {
    write(2);
    Names expected = record_;
    expected.insert({"fields", "fields/frame-000000.vtu", "fields/frame-000001.vtu", "fields.pvd"});
    EXPECT_EQ(names(), expected);
    EXPECT_EQ(content_of(here_ / "fields/frame-000001.vtu"), vtu_text(small_grid(1)));
    EXPECT_NE(
        content_of(here_ / "fields.pvd").find("timestep=\"1\" part=\"0\" file=\"fields/frame-000001.vtu\""),
        std::string::npos);
}

TEST_F(FieldFilesTest, AShorterRunTakesTheRestOfALongerOneAway) {
    write(5);
    write(2);
    EXPECT_EQ(names().size(), record_.size() + 4);
    write(0);
    EXPECT_EQ(names(), record_);
}

TEST_F(FieldFilesTest, ARunThatBeginsAnewLeavesItsOwnFramesAlone) {
    write(5);
    for (const bool named_by_a_checkpoint : {false, true}) {
        FileBatch batch;
        FieldFiles fields(batch, here_.path());
        for (const int time : {0, 1, 2})
            fields.add(small_grid(time));
        if (named_by_a_checkpoint) fields.written();
        for (const int time : {0, 3})
            fields.add(small_grid(time));
        EXPECT_EQ(fields.count(), 2u);
        fields.finish();
        add_record(batch, {}, here_.path());
        batch.commit();
        Names expected = record_;
        expected.insert({"fields", "fields/frame-000000.vtu", "fields/frame-000001.vtu", "fields.pvd"});
        EXPECT_EQ(names(), expected);
        EXPECT_EQ(content_of(here_ / "fields/frame-000001.vtu"), vtu_text(small_grid(3)));
    }
}

TEST_F(FieldFilesTest, FramesOfTheRunBeforeStayForItsCheckpoint) {
    std::vector<WrittenFrame> named;
    {
        FileBatch batch;
        FieldFiles fields(batch, here_.path());
        fields.compute_checksums();
        fields.add(small_grid(1));
        named = fields.written();
        fields.add(small_grid(0));  // and is killed
    }
    FileBatch batch;
    FieldFiles fields(batch, here_.path());
    fields.adopt(named);
    EXPECT_EQ(fields.count(), 1u);
}

TEST_F(FieldFilesTest, WhatIsNotOursStays) {
    write(2);
    const Names theirs{"fields/my-camera.pvsm", "fields/frame-1.vtu", "fields/frame-00000x.vtu"};
    for (const std::string& name : theirs)
        here_.write(name, "mine");
    write(0);
    Names expected = record_;
    expected.insert("fields");
    expected.insert(theirs.begin(), theirs.end());
    EXPECT_EQ(names(), expected);
}

TEST_F(FieldFilesTest, WithoutACommitTheEarlierFieldsStay) {
    write(3);
    const Names before = names();
    write(1, false);
    EXPECT_EQ(names(), before);
}

TEST_F(FieldFilesTest, ACommitThatFailsBringsTheEarlierFieldsBack) {
    write(3);
    const Names before = names();
    FileBatch batch;
    remove_old_fields(batch, here_.path());
    batch.add(here_ / "events.csv", "new");
    for (const std::string& name : names())
        if (name.starts_with(".events.csv")) fs::remove(here_ / name);  // commit() has nothing to rename
    EXPECT_THROW(batch.commit(), WriteError);
    EXPECT_EQ(names(), before);
}

}  // namespace
}  // namespace twinchute
