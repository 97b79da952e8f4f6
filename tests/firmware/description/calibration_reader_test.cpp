// [calibration.CHANNEL]: what a certificate says stands in the rig description.
#include "firmware/description/calibration_reader.hpp"

#include <gtest/gtest.h>

#include <string>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "tests/support/temporary_folder.hpp"

namespace calibration_reader_test {
namespace {

using firmware::CalendarDate;
using firmware::certificate_objections;
using firmware::parse_rig;
using model::Channel;

const std::string bench =
    "kind = 'component_bench'\nsample_rate = 1000.0\n[suspension]\nstiffness = 30000.0\ndamping = 1000.0\n";

firmware::RigDescription with(const std::string& lines) { return parse_rig(bench + lines, "rig.toml"); }

std::string error_of(const std::string& lines) {
  try {
    static_cast<void>(with(lines));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "no error";
}

// What is written reads back to the same, a date in quotes or as TOML has it.
TEST(CalibrationReader, ReadsWhatTheWriterWrites) {
  const auto first = with(
      "[calibration.F]\ngain = 0.002\noffset = 0.5\nk = 2.1\ndate = 2026-03-01\nvalid_until = '2027-02-28'\n"
      "certificate = 'D-K-15019 \"4711\"'\nserial = 'A1'\ncertificate_serial = 'A2'\ncertificate_channel = 'x_act'\n"
      "[calibration.x_act]\ngain = 1e-3\n");
  const auto again = parse_rig(firmware::format_rig(first), "again.toml");
  for (const auto* description : {&first, &again}) {
    const auto& force = description->calibration[index(Channel::F)];
    ASSERT_TRUE(force);
    EXPECT_EQ(force->gain, 0.002);
    EXPECT_EQ(force->offset, 0.5);
    EXPECT_EQ(force->k, 2.1);
    EXPECT_EQ(*force->date, (CalendarDate{2026, 3, 1}));
    EXPECT_EQ(*force->valid_until, (CalendarDate{2027, 2, 28}));
    EXPECT_EQ(force->certificate, "D-K-15019 \"4711\"");
    EXPECT_EQ(force->serial, "A1");
    EXPECT_EQ(force->certificate_serial, "A2");
    EXPECT_EQ(force->certificate_channel, Channel::x_act);
    const auto& deflection = description->calibration[index(Channel::x_act)];
    ASSERT_TRUE(deflection);
    EXPECT_EQ(deflection->k, 2.0);
    EXPECT_FALSE(deflection->valid_until);
    EXPECT_FALSE(description->calibration[index(Channel::F_w)]);
  }
}

// Point. An expanded uncertainty is k standard deviations.
TEST(CalibrationReader, DividesByTheCoverageFactor) {
  const auto force = *with("[calibration.F]\ngain = 0.003\noffset = 6.0\nk = 3.0\n").calibration[index(Channel::F)];
  EXPECT_DOUBLE_EQ(force.standard_gain(), 0.001);
  EXPECT_DOUBLE_EQ(force.standard_offset(), 2.0);
}

// Each wrong entry is an error in one line that names file, line and key.
TEST(CalibrationReader, RefusesWhatDoesNotFit) {
  const std::string gain = "[calibration.F]\ngain = 0.002\n";
  for (const auto& [lines, key] : std::vector<std::pair<std::string, std::string>>{
           {"[calibration.F]\ngain = -0.002\n", "rig.toml:7: calibration.F.gain"},
           {"[calibration.F]\ngain = 0.0\n", "rig.toml:7: [calibration.F] states no uncertainty"},
           {"[calibration.F]\ncertificate = 'A'\n", "[calibration.F] states no uncertainty"},
           {"[calibration.F]\ngain = 2.0\n", "calibration.F.gain = 2"},
           {"[calibration.F]\noffset = -1.0\n", "calibration.F.offset"},
           {gain + "k = 0.1\n", "rig.toml:8: calibration.F.k"},
           {gain + "date = '2026-02-29'\n", "rig.toml:8: calibration.F.date is no day of the calendar"},
           {gain + "date = '1.3.2026'\n", "calibration.F.date"},
           {gain + "valid_until = 2026\n", "calibration.F.valid_until"},
           {gain + "date = '2026-03-01'\nvalid_until = '2026-02-28'\n",
            "rig.toml:9: calibration.F.valid_until is before calibration.F.date"},
           {gain + "certificate = ' '\n", "calibration.F.certificate is empty"},
           {gain + "certificate_serial = 'A'\n", "calibration.F.certificate_serial stands without"},
           {gain + "certificate_channel = 'G'\n", "unknown channel"},
           {gain + "valid_to = '2026-02-28'\n", "did you mean"},
           {"[calibration.G]\ngain = 0.002\n", "unknown channel"},
           {"[calibration.x_cmd]\ngain = 0.002\n", "commands x_cmd itself"},
           {"[calibration]\nF = 0.002\n", "calibration.F"}}) {
    EXPECT_NE(error_of(lines).find(key), std::string::npos) << lines << error_of(lines);
  }
}

// Point. The last day counts, the day after does not; what is foreign is so on any day.
TEST(CertificateObjections, SayExpiredEarlyAndForeign) {
  const auto dated = with(
      "[calibration.F]\ngain = 0.002\ndate = '2026-03-01'\nvalid_until = '2027-02-28'\n"
      "certificate = '4711'\n");
  EXPECT_TRUE(certificate_objections(dated.calibration, {2026, 3, 1}).empty());
  EXPECT_TRUE(certificate_objections(dated.calibration, {2027, 2, 28}).empty());
  const auto late = certificate_objections(dated.calibration, {2027, 3, 1});
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0], "the certificate 4711 of F expired on 2027-02-28, before the recording (2027-03-01)");
  const auto early = certificate_objections(dated.calibration, {2026, 2, 28});
  ASSERT_EQ(early.size(), 1U);
  EXPECT_EQ(early[0], "the certificate 4711 of F is of 2026-03-01, after the recording (2026-02-28)");
  const auto foreign = certificate_objections(
      with("[calibration.F]\ngain = 0.002\nserial = 'A1'\ncertificate_serial = 'A2'\ncertificate_channel = 'x_act'\n")
          .calibration,
      {2026, 1, 1});
  ASSERT_EQ(foreign.size(), 2U);
  EXPECT_EQ(foreign[0], "the certificate of F is foreign: it is for the sensor A2, but A1 is fitted");
  EXPECT_EQ(foreign[1], "the certificate of F is foreign: it is for the channel x_act");
  EXPECT_TRUE(certificate_objections(with("[calibration.F]\ngain = 0.002\nserial = 'A1'\ncertificate_serial = 'A1'\n"
                                          "certificate_channel = 'F'\n")
                                         .calibration,
                                     {2026, 1, 1})
                  .empty());
}

// Point. ISO dates only, and only days that are.
TEST(CalendarDate, IsReadAsIsoHasIt) {
  EXPECT_EQ(*firmware::find_date("2028-02-29"), (CalendarDate{2028, 2, 29}));
  for (const char* const text : {"2027-02-29", "2026-13-01", "2026-00-10", "2026-1-01", "2026/01/01", "20260101",
                                 "+026-01-01", "2026-01-01T00", "0000-01-01", ""}) {
    EXPECT_FALSE(firmware::find_date(text)) << text;
  }
  EXPECT_EQ(firmware::date_text({2026, 3, 1}), "2026-03-01");
  EXPECT_LT((CalendarDate{2026, 2, 28}), (CalendarDate{2026, 3, 1}));
  EXPECT_GE(firmware::today(), (CalendarDate{2026, 1, 1}));
}

// A user looks a key up in the table of keys.
TEST(CalibrationReader, HasEveryKeyInTheReadme) {
  const std::string readme = support::TemporaryFolder::read("firmware/description/README.md");
  for (const char* const key : {"`[calibration.CHANNEL]`", "`gain`", "`offset`", "`k`", "`date`", "`valid_until`",
                                "`certificate`", "`serial`", "`certificate_serial`", "`certificate_channel`"}) {
    EXPECT_NE(readme.find(key), std::string::npos) << key;
  }
}

}  // namespace
}  // namespace calibration_reader_test
