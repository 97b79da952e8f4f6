// [compensation]: read, written, refused; what follows from the rig; that a controller wants it proven.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "firmware/description/compensation_reader.hpp"
#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/loop_proof.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "tests/support/rig_texts.hpp"
#include "tests/support/temporary_folder.hpp"

namespace {

using firmware::RigDescription;
using firmware::compensation::Kind;

std::string paper_rig_text() { return support::TemporaryFolder::read(support::rig_file("paper_hil_fdva")); }

RigDescription with_keys(const std::string& keys, const std::string& text = paper_rig_text()) {
  return firmware::parse_rig(text + "\n[compensation]\n" + keys + "\n", "rig.toml");
}

std::string refusal(const std::string& keys, const std::string& text = paper_rig_text()) {
  try {
    static_cast<void>(with_keys(keys, text));
  } catch (const firmware::InputError& error) {
    return error.what();
  }
  return "accepted";
}

// Law. What is read is what is written.
TEST(CompensationDescription, IsWrittenAsItWasRead) {
  std::string keys = "kind = \"adaptive_time_series\"\norder = 1\nlowest = [0.9, 0.0, 0.0, 0.0]\n";
  for (const auto& key : firmware::compensation_keys()) {
    keys += std::string(key.key) + " = " + std::to_string(0.5 * (key.lowest + key.highest)) + "\n";
  }
  const RigDescription read = with_keys(keys);
  const RigDescription again = firmware::parse_rig(firmware::format_rig(read), "again.toml");
  ASSERT_TRUE(read.compensation && again.compensation);
  EXPECT_EQ(again.compensation->kind, Kind::adaptive_time_series);
  EXPECT_EQ(again.compensation->numbers, read.compensation->numbers);
  EXPECT_EQ(again.compensation->lists, read.compensation->lists);
  EXPECT_EQ(again.compensation->numbers.size(), firmware::compensation_keys().size() + 1);
  EXPECT_FALSE(firmware::parse_rig(paper_rig_text(), "rig.toml").compensation);
}

// Law. Every method can be described by its kind alone: the machine is that of the effects that diagnose names, with
// the delays that no effect models.
TEST(CompensationDescription, TakesTheMachineFromTheEffects) {
  const std::string machine =
      "[effects.actuator_lag]\ntime_constant = 0.004\n[effects.sensor_delay.F]\ndelay = 0.001\n"
      "[delay_budget]\nsensor_age = 0.0005\ntransport = 0.0002\n";
  for (std::size_t k = 0; k < firmware::compensation::kind_names.size(); ++k) {
    const auto rig =
        with_keys("kind = \"" + std::string(firmware::compensation::kind_names[k]) + "\"", paper_rig_text() + machine);
    const auto settings = firmware::compensation_settings(rig);
    ASSERT_TRUE(settings);
    EXPECT_EQ(settings->kind, static_cast<Kind>(k));
    EXPECT_NEAR(settings->machine.delay, 0.010 + 0.001 + 0.0007, 1e-15);
    EXPECT_EQ(settings->machine.lag, 0.004);
    EXPECT_EQ(settings->component.stiffness, 31500.0);
    EXPECT_TRUE(settings->component.has_fdva);
    EXPECT_GT(settings->damping, 100.0);
    EXPECT_NE(firmware::compensation_of(rig), nullptr);
  }
  const auto own = firmware::compensation_settings(with_keys("kind = \"inverse\"\ndelay = 0.008\n"));
  EXPECT_EQ(own->machine.delay, 0.008);
  const auto given =
      firmware::compensation_settings(with_keys("kind = \"inverse\"\ncoefficients = [1.0, 0.009, 4e-5, 0.0]\n"));
  EXPECT_EQ(given->given[1], 0.009);
  EXPECT_EQ(firmware::compensation_of(firmware::parse_rig(paper_rig_text(), "rig.toml")), nullptr);
}

// Point. Where the wheel load has its peak without delay: 14.2 Hz with the absorber and no virtual damping
// (host_sim/compensation/README.md); the inverse is exact there, e^{jωτ} = a₀ + j a₁ ω − a₂ ω² in its argument.
TEST(CompensationDescription, FitsTheInverseAtTheWheelMode) {
  auto rig = with_keys("kind = \"inverse\"",
                       support::with(paper_rig_text(), "virtual_damping = 1140.0", "virtual_damping = 0.0"));
  const double omega = firmware::wheel_mode(rig.rig);
  EXPECT_NEAR(omega / 6.283185307179586, 14.2, 0.1);
  const auto a = firmware::compensation_settings(rig)->assumed();
  EXPECT_NEAR(a[1] * omega, std::sin(omega * 0.010), 1e-12);
  EXPECT_NEAR(1.0 - a[2] * omega * omega, std::cos(omega * 0.010), 1e-12);
}

// Fault. Each mistake is named with its key and line.
TEST(CompensationDescription, RefusesWhatDoesNotFit) {
  EXPECT_EQ(refusal("kind = \"inverse\""), "accepted");
  for (const auto& [keys, words] : std::map<std::string, std::string>{
           {"kind = \"invers\"", "did you mean 'inverse'"},
           {"delay = 0.01", "kind"},
           {"kind = \"inverse\"\ndelay = -0.01", "compensation.delay"},
           {"kind = \"inverse\"\ndelay = 10.0", "compensation.delay"},
           {"kind = \"inverse\"\norder = 4", "compensation.order"},
           {"kind = \"inverse\"\ndely = 0.01", "did you mean 'compensation.delay'"},
           {"kind = \"inverse\"\ncoefficients = [1.0, 0.01]", "four numbers"},
           {"kind = \"inverse\"\ncoefficients = [1.0, 0.01, \"x\", 0.0]", "coefficients"},
           {"kind = \"inverse\"\ncoefficients = [5.0, 0.01, 0.0, 0.0]", "compensation.coefficients"},
           {"kind = \"adaptive_time_series\"\nlowest = [2.0, 0.0, 0.0, 0.0]", "lowest"},
           {"kind = \"polynomial\"\ndelay = 0.19", "252 periods"}}) {
    EXPECT_NE(refusal(keys).find(words), std::string::npos) << keys << ": " << refusal(keys);
    EXPECT_NE(refusal(keys).find("rig.toml:"), std::string::npos) << refusal(keys);
  }
  EXPECT_NE(refusal("kind = \"inverse\"", support::TemporaryFolder::read(support::rig_file("paper_rig_fdva")))
                .find("this is a quarter_car"),
            std::string::npos);
  EXPECT_THROW(firmware::refuse_compensation(with_keys("kind = \"inverse\""), "diagnose"), firmware::InputError);
}

// Law. The proof is one of the compensated loop: another kind or number, and none at all, take it away.
TEST(CompensationDescription, EntersTheProof) {
  const std::string plain = firmware::loop_fingerprint(firmware::parse_rig(paper_rig_text(), "rig.toml"));
  const std::string one = firmware::loop_fingerprint(with_keys("kind = \"inverse\""));
  EXPECT_NE(one, plain);
  EXPECT_NE(firmware::loop_fingerprint(with_keys("kind = \"smith\"")), one);
  EXPECT_NE(firmware::loop_fingerprint(with_keys("kind = \"inverse\"\ndelay = 0.009")), one);
  EXPECT_NE(firmware::loop_fingerprint(with_keys("kind = \"inverse\"\ncoefficients = [1.0, 0.01, 0.0, 0.0]")), one);
  EXPECT_EQ(firmware::loop_fingerprint(with_keys("kind = \"inverse\" # as before")), one);
  EXPECT_NE(firmware::stability_objection(with_keys("kind = \"inverse\"")).text.find("with its compensation"),
            std::string::npos);
}

}  // namespace
