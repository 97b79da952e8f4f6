// Excel workbooks as text: cells of every kind, in their places.
#include "host_sim/recording_files/binary/workbook_file.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/recording_files/import.hpp"
#include "tests/support/temporary_folder.hpp"

namespace workbook_file_test {
namespace {

const std::string strings =
    "<sst><si><t>Zeit [s]</t></si><si><r><t>Kraft </t></r><r><t>[N]</t></r><rPh><t>x</t></rPh></si></sst>";
const std::string styles =
    "<styleSheet><numFmts><numFmt numFmtId=\"164\" formatCode=\"hh:mm:ss.000\"/>"
    "<numFmt numFmtId=\"165\" formatCode=\"0.00&quot;s&quot;\"/></numFmts>"
    "<cellStyleXfs><xf numFmtId=\"22\"/></cellStyleXfs>"
    "<cellXfs><xf numFmtId=\"0\"/><xf numFmtId=\"164\"/><xf numFmtId=\"165\"/><xf "
    "numFmtId=\"22\"/></cellXfs></styleSheet>";

// Point. A cell left out is an empty field, a row left out an empty line; the kinds of cells of ECMA-376, 18.18.11.
TEST(WorkbookFile, CellsStandInTheirPlaces) {
  const std::string sheet =
      "<x:worksheet><x:sheetData><x:row r=\"1\"><x:c r=\"A1\" t=\"s\"><x:v>0</x:v></x:c><x:c r=\"C1\" "
      "t=\"s\"><x:v>1</x:v></x:c></x:row>"
      "<x:row r=\"3\"><x:c r=\"B3\"><x:v>2.5</x:v></x:c><x:c r=\"C3\" t=\"str\"><x:f>A1</x:f><x:v>a &lt; "
      "&#xe4;</x:v></x:c>"
      "<x:c r=\"D3\" t=\"inlineStr\"><x:is><x:t>in</x:t></x:is></x:c><x:c r=\"E3\" t=\"e\"><x:v>#N/A</x:v></x:c>"
      "<x:c r=\"F3\"/></x:row></x:sheetData></x:worksheet>";
  EXPECT_EQ(host_sim::text_of_sheet(sheet, strings, styles), "Zeit [s]\t\tKraft [N]\n\n\t2.5\ta < ä\tin\t#N/A\t\n");
}

// Point. 45363.5 days are noon of 12 March 2024 (Excel's own); the styles are by their formats.
TEST(WorkbookFile, DatesAndTimesAreDatesAndTimes) {
  const auto cell = [](int style, const std::string& value) {
    return "<c r=\"A1\" s=\"" + std::to_string(style) + "\"><v>" + value + "</v></c>";
  };
  EXPECT_EQ(host_sim::text_of_sheet(cell(3, "45363.5"), "", styles), "2024-03-12 12:00:00.000000\n");
  EXPECT_EQ(host_sim::text_of_sheet(cell(1, "0.25"), "", styles), "06:00:00.000000\n");
  EXPECT_EQ(host_sim::text_of_sheet(cell(2, "0.25"), "", styles), "0.25\n");
  EXPECT_EQ(host_sim::text_of_sheet(cell(0, "45363.5"), "", styles), "45363.5\n");
  EXPECT_EQ(host_sim::text_of_sheet(cell(3, "43901.5"), "", styles, -24107), "2024-03-12 12:00:00.000000\n");
}

std::string little_endian(std::uint32_t value, int size) {
  std::string bytes;
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffU);
  return bytes;
}

// A ZIP archive without compression (PKWARE, APPNOTE 6.3, 4.3).
std::string archive_of(const std::vector<std::pair<std::string, std::string>>& parts) {
  std::string files, directory;
  for (const auto& [name, bytes] : parts) {
    std::uint32_t crc = 0xffffffff;
    for (const char c : bytes) {
      crc ^= static_cast<unsigned char>(c);
      for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? 0xedb88320U ^ crc >> 1U : crc >> 1U;
    }
    const auto size = static_cast<std::uint32_t>(bytes.size());
    const std::string common = little_endian(10, 2) + little_endian(0, 2) + little_endian(0, 2) + little_endian(0, 2) +
                               little_endian(0x21, 2) + little_endian(~crc, 4) + little_endian(size, 4) +
                               little_endian(size, 4) + little_endian(static_cast<std::uint32_t>(name.size()), 2) +
                               little_endian(0, 2);
    directory += little_endian(0x02014b50, 4) + little_endian(10, 2) + common + std::string(10, '\0') +
                 little_endian(static_cast<std::uint32_t>(files.size()), 4) + name;
    files += little_endian(0x04034b50, 4) + common + name + bytes;
  }
  const auto entries = static_cast<std::uint32_t>(parts.size());
  return files + directory + little_endian(0x06054b50, 4) + std::string(4, '\0') + little_endian(entries, 2) +
         little_endian(entries, 2) + little_endian(static_cast<std::uint32_t>(directory.size()), 4) +
         little_endian(static_cast<std::uint32_t>(files.size()), 4) + little_endian(0, 2);
}

TEST(WorkbookFile, TheSheetWithATableIsImported) {
  std::string rows = "<row r=\"1\"><c r=\"A1\" t=\"s\"><v>0</v></c><c r=\"B1\" t=\"s\"><v>1</v></c></row>";
  for (int k = 0; k < 20; ++k) {
    const std::string row = std::to_string(k + 2);
    rows += "<row r=\"" + row + "\"><c r=\"A" + row + "\"><v>" + std::to_string(0.001 * k) + "</v></c><c r=\"B" + row +
            "\"><v>" + std::to_string(2 * k) + "</v></c></row>";
  }
  const support::TemporaryFolder folder;
  const auto file = folder.write(
      "run.xlsx",
      archive_of({{"[Content_Types].xml", "<Types/>"},
                  {"xl/workbook.xml",
                   "<workbook><sheets><sheet name=\"Notes\" r:id=\"rId1\"/>"
                   "<sheet name=\"Data\" r:id=\"rId2\"/></sheets></workbook>"},
                  {"xl/_rels/workbook.xml.rels",
                   "<Relationships><Relationship Id=\"rId1\" Target=\"worksheets/a.xml\"/>"
                   "<Relationship Id=\"rId2\" Target=\"/xl/worksheets/b.xml\"/></Relationships>"},
                  {"xl/worksheets/a.xml", "<sheetData><row r=\"1\"><c r=\"A1\" t=\"s\"><v>1</v></c></row></sheetData>"},
                  {"xl/worksheets/b.xml", "<sheetData>" + rows + "</sheetData>"},
                  {"xl/sharedStrings.xml", strings},
                  {"xl/styles.xml", styles}}));
  const host_sim::Import import = host_sim::import_file(file, {firmware::ChannelMap{}});
  EXPECT_EQ(import.format, "Excel workbook, sheet 'Data'");
  ASSERT_EQ(import.recording.size(), 20U);
  EXPECT_NEAR(import.recording.time[19], 0.019, 1e-12);
  EXPECT_EQ(import.recording[model::Channel::F][19], 38.0);
  ASSERT_EQ(import.left_out.size(), 1U);
  EXPECT_EQ(import.left_out[0].name, "sheet Notes");
}

}  // namespace
}  // namespace workbook_file_test
