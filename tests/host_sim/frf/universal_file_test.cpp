// The universal file, read back by the description of its format: field by field, by column.
#include "host_sim/frf/universal_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "tests/host_sim/frf/signals.hpp"
#include "tests/support/universal_file.hpp"

namespace {

using host_sim::frf::OutputResponse;
using host_sim::frf::Responses;
using model::Channel;
using support::universal::File;
using support::universal::Function;
using support::universal::Record;

Responses some_responses() {
  Responses r;
  r.request.input = Channel::z_r;
  r.request.outputs = {Channel::F_w, Channel::zdd_b};
  r.sample_rate = 1000.0;
  r.averages = 118;
  r.effective_averages = 111.9;
  r.blocks.scheme.length = 1500;
  for (int k = 1; k <= 5; ++k) r.frequency.push_back(k / 1.5);
  OutputResponse force;
  force.output = Channel::F_w;
  force.magnitude = {1.23456789012345e5, 2.0, 3e-7, 4.0, 5e120};
  force.phase = {0.1, -3.0, 7.5, 0.0, 1.0};
  force.coherence = {0.999999999999, 0.5, 0.25, 0.125, 1.0};
  OutputResponse acceleration = force;
  acceleration.output = Channel::zdd_b;
  acceleration.magnitude[2] = std::numeric_limits<double>::quiet_NaN();
  r.outputs = {force, acceleration};
  return r;
}

// Golden by the format's description. Units first, then a response and its coherence for each output; numbers come back
// to the 13 digits that the format has, frequencies to its six.
TEST(UniversalFile, IsReadBackByItsDescription) {
  const Responses r = some_responses();
  File file(host_sim::frf::to_universal_file(r));
  ASSERT_EQ(file.dataset(), 164);
  Record units = file.record();
  EXPECT_EQ(units.integer(10), 1) << "SI";
  EXPECT_EQ(units.text(20), "SI: Metric Abs (SI)");
  EXPECT_EQ(units.integer(10), 2);
  for (int i = 0; i < 2; ++i) static_cast<void>(file.record());  // factors 1, offset of the temperature
  file.delimiter();

  for (const OutputResponse& o : r.outputs) {
    for (const bool response : {true, false}) {
      ASSERT_EQ(file.dataset(), 58);
      const Function f = file.function();
      EXPECT_EQ(f.type, response ? 4 : 6);
      EXPECT_EQ(f.data_type, response ? 6 : 4);
      EXPECT_EQ(f.response, model::name(o.output));
      EXPECT_EQ(f.reference, "z_r");
      EXPECT_EQ(f.response_node, o.output == Channel::F_w ? 4 : 3);
      EXPECT_EQ(f.reference_node, 1);
      EXPECT_EQ(f.response_direction, 3);
      EXPECT_EQ(f.reference_direction, 3);
      EXPECT_EQ(f.number, &o == &r.outputs.front() ? 1 : 2);
      EXPECT_EQ(f.points, 5);
      EXPECT_EQ(f.spacing, 1);
      EXPECT_EQ(f.first, 0.666667);
      EXPECT_EQ(f.increment, 0.666667);
      EXPECT_EQ(f.axes[0].type, 18);
      EXPECT_EQ(f.axes[0].unit, "Hz");
      if (response) {
        EXPECT_EQ(f.axes[1].type, o.output == Channel::F_w ? 9 : 12);
        EXPECT_EQ(f.axes[1].length, o.output == Channel::F_w ? 0 : 1);
        EXPECT_EQ(f.axes[1].force, o.output == Channel::F_w ? 1 : 0);
        EXPECT_EQ(f.axes[1].unit, o.output == Channel::F_w ? "N" : "m/s^2");
        EXPECT_EQ(f.axes[2].type, 8);
        EXPECT_EQ(f.axes[2].length, 1);
        EXPECT_EQ(f.axes[2].unit, "m");
        EXPECT_EQ(f.id[0], "H1 " + std::string(model::name(o.output)) + " / z_r");
      }
      for (std::size_t k = 0; k < 5; ++k) {
        const bool known = std::isfinite(o.magnitude[k]);
        if (response) {
          const std::complex<double> h = known ? std::polar(o.magnitude[k], o.phase[k]) : 0.0;
          EXPECT_LE(std::abs(f.numbers[2 * k] - h.real()), 1e-12 * std::abs(h)) << k;
          EXPECT_LE(std::abs(f.numbers[2 * k + 1] - h.imag()), 1e-12 * std::abs(h)) << k;
        } else {
          EXPECT_NEAR(f.numbers[k], known ? o.coherence[k] : 0.0, 1e-12) << k;
        }
      }
    }
  }
  EXPECT_TRUE(file.at_end());
}

}  // namespace
