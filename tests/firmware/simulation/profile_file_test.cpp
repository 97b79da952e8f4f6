// Roads from files, over time and over the way.
#include "firmware/simulation/profile_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/recording/recording_csv.hpp"
#include "tests/support/temporary_folder.hpp"

namespace profile_file_test {
namespace {

firmware::FootPointMotion road_from_file(const std::filesystem::path& file, double speed, double sample_rate,
                                         std::size_t samples) {
  return firmware::road_from_file(file, speed, sample_rate, samples, firmware::read_csv_recording);
}

using firmware::FootPointMotion;
using support::TemporaryFolder;

constexpr double omega = 2.0 * 3.141592653589793 * 2.0;  // 2 Hz
constexpr std::size_t everything = 1000000000;

/// Points a step apart of z_r = 0.01 sin(ω · place/speed), under the given header, for one second at that speed.
std::string sine(const std::string& header, double step, double speed) {
  std::string text = header + "\n";
  const int points = static_cast<int>(std::lround(speed / step));
  for (int k = 0; k <= points; ++k) {
    const double place = k * step;
    text += firmware::shortest(place) + "," + firmware::shortest(0.01 * std::sin(omega * place / speed)) + "\n";
  }
  return text;
}

double worst_error(const FootPointMotion& motion, double rate) {
  double worst = 0.0;
  for (std::size_t k = 0; k < motion.size(); ++k) {
    worst = std::max(worst, std::abs(motion[k].position - 0.01 * std::sin(omega * static_cast<double>(k) / rate)));
  }
  return worst;
}

std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "accepted";
}

// The points themselves where the file has the rig's rate, to the bit.
TEST(ProfileFile, GivesThePointsOfAFileAtTheRate) {
  const TemporaryFolder folder;
  const auto file = folder.write("road.csv", "t,z_r\n0,0.001\n0.001,0.002\n0.002,-0.003\n0.003,0.004\n0.004,0.005\n");
  const auto motion = road_from_file(file, 30.0, 1000.0, 100);
  ASSERT_EQ(motion.size(), 5U);
  for (const auto& [k, z] : {std::pair{0U, 0.001}, {1U, 0.002}, {2U, -0.003}, {3U, 0.004}, {4U, 0.005}}) {
    EXPECT_EQ(motion[k].position, z) << k;
  }
  EXPECT_EQ(road_from_file(file, 30.0, 1000.0, 3).size(), 3U) << "no more samples than wanted";
}

// Over the way: s = v t. The header may name it in several ways; at half the speed it takes twice the time.
TEST(ProfileFile, DrivesOverAWayAtTheGivenSpeed) {
  const TemporaryFolder folder;
  for (const char* header : {"s,z_r", "s [m],z_r [m]", "\"s\",z_r", "# a comment\n\ns,z_r", "\xef\xbb\xbfs,z_r"}) {
    const auto file = folder.write("road.csv", sine(header, 0.02, 20.0));
    const auto motion = road_from_file(file, 20.0, 1000.0, everything);
    ASSERT_EQ(motion.size(), 1001U) << header;
    EXPECT_LT(worst_error(motion, 1000.0), 1e-9) << header;
    EXPECT_EQ(road_from_file(file, 10.0, 1000.0, everything).size(), 2001U);
  }
  const auto time = folder.write("time.csv", sine("t,z_r", 0.001, 1.0));
  EXPECT_EQ(road_from_file(time, 20.0, 1000.0, everything).size(), 1001U) << "a speed has no part in a road over time";
}

// Order. Between points the error falls as h⁴: cubic Hermite h⁴/384 |z⁗| plus what fourth-order velocities lack,
// h/8 · h⁴/30 |z⁽⁵⁾| on each side, which is of fifth order. (The ends, with velocities of second order, left out.)
TEST(ProfileFile, InterpolatesToFourthOrder) {
  const TemporaryFolder folder;
  const auto error = [&folder](double step) {
    const auto file = folder.write("road.csv", sine("t,z_r", step, 1.0));
    const auto motion = road_from_file(file, 1.0, 5000.0, everything);
    double worst = 0.0;
    for (std::size_t k = 500; k + 500 < motion.size(); ++k) {
      const double t = static_cast<double>(k) / 5000.0;
      worst = std::max(worst, std::abs(motion[k].position - 0.01 * std::sin(omega * t)));
    }
    return worst;
  };
  const double coarse = error(0.02), fine = error(0.01);
  EXPECT_NEAR(coarse, std::pow(0.02, 4) / 384.0 * 0.01 * std::pow(omega, 4), 0.1 * coarse);
  EXPECT_NEAR(coarse / fine, 17.0, 1.0);  // 16, and a little of the fifth order's 32
}

// Velocity and acceleration belong to the motion, also in between: a parabola has them exactly.
TEST(ProfileFile, GivesTheMotionOfAParabolaExactly) {
  const TemporaryFolder folder;
  std::string text = "t,z_r\n";
  for (int k = 0; k <= 20; ++k) {
    text += firmware::shortest(k * 0.01) + "," + firmware::shortest(0.5 * k * k * 1e-4) + "\n";
  }
  const auto motion = road_from_file(folder.write("road.csv", text), 1.0, 1000.0, 1000);
  ASSERT_EQ(motion.size(), 201U);
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const double t = static_cast<double>(k) * 1e-3;
    EXPECT_NEAR(motion[k].position, 0.5 * t * t, 1e-15) << k;
    EXPECT_NEAR(motion[k].velocity, t, 1e-13) << k;
    EXPECT_NEAR(motion[k].acceleration, 1.0, 1e-10) << k;
  }
}

// A file that begins at some time, and one finer than the rig.
TEST(ProfileFile, TakesAnyBeginningAndAnyFinerSpacing) {
  const TemporaryFolder folder;
  const auto late = folder.write("late.csv", "t,z_r\n7,0\n7.5,1\n8,2\n8.5,3\n9,4\n");
  EXPECT_NEAR(road_from_file(late, 1.0, 4.0, 100)[3].position, 1.5, 1e-15);
  const auto fine = folder.write("fine.csv", sine("t,z_r", 0.0005, 1.0));
  const auto motion = road_from_file(fine, 1.0, 100.0, 1000);
  ASSERT_EQ(motion.size(), 101U);
  EXPECT_LT(worst_error(motion, 100.0), 1e-9);
}

TEST(ProfileFile, RefusesWhatIsNoRoad) {
  const TemporaryFolder folder;
  const auto refusal = [&folder](const std::string& text) {
    const auto file = folder.write("road.csv", text);
    return refusal_of([&] { static_cast<void>(road_from_file(file, 20.0, 1000.0, 100)); });
  };
  EXPECT_NE(refusal("t,z_r\n0,0\n1,0\n2,0\n3,0\n").find("a road of 4 points, expected at least five"),
            std::string::npos);
  EXPECT_NE(refusal("t,z_w\n0,0\n1,0\n2,0\n3,0\n4,0\n").find("z_r"), std::string::npos);
  EXPECT_NE(refusal("x,z_r\n0,0\n1,0\n2,0\n3,0\n4,0\n").find("expected"), std::string::npos) << "neither time nor way";
  EXPECT_NE(refusal("s,z_r\n0,0\n1,0\n2,nan\n3,0\n4,0\n").find("road.csv:4: "), std::string::npos);
  EXPECT_NE(refusal("s,z_r\n0,0\n1,0\n3,0\n4,0\n5,0\n").find("road.csv:"), std::string::npos) << "a gap";
  EXPECT_NE(refusal("").find("road.csv"), std::string::npos);
  const auto folder_as_file = [&] { static_cast<void>(road_from_file(folder.path(), 20.0, 1000.0, 100)); };
  EXPECT_NE(refusal_of(folder_as_file).find("directory"), std::string::npos);
}

}  // namespace
}  // namespace profile_file_test
