#include "firmware/simulation/profile_file.hpp"

#include <cmath>
#include <fstream>
#include <string>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/values/channel_map.hpp"

namespace firmware {

namespace {

/// Whether the header speaks of the way s instead of the time t.
bool is_over_way(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  while (std::getline(stream, line)) {
    if (line.empty() || line[0] == '#') continue;
    const auto first = line.find_first_not_of(" \t\"\xef\xbb\xbf");
    if (first == std::string::npos || line[first] != 's') return false;
    return first + 1 == line.size() || line.find_first_of(" ,[\t\r\"", first) == first + 1;
  }
  return false;
}

Recording read_profile(const std::filesystem::path& file, double speed, RecordingReader read) {
  ChannelMap map;
  if (is_over_way(file)) map["t"] = {"s", 1.0 / speed, 0.0};
  return read(file, map, std::nullopt);
}

FootPointMotion motion_of(const std::filesystem::path& file, const Recording& road, const std::vector<double>& z,
                          double sample_rate, std::size_t samples) {
  constexpr std::size_t least = 5;  // points that the differences of fourth order need
  if (z.size() < least) {
    throw InputError(file.string(), 0, "a road of " + std::to_string(z.size()) + " points", "at least five");
  }
  const double spacing = road.sample_period;
  const FootPointMotion points = through_samples(z, 1.0 / spacing);
  const double length = spacing * static_cast<double>(points.size() - 1);
  const auto available = static_cast<std::size_t>(std::floor(length * sample_rate + 1e-6)) + 1;
  FootPointMotion motion(std::min(samples, available));
  for (std::size_t k = 0; k < motion.size(); ++k) {
    const double place = static_cast<double>(k) / (sample_rate * spacing);
    auto i = static_cast<std::size_t>(place + 1e-9);
    double s = place - static_cast<double>(i);
    if (std::abs(s) < 1e-9 || i + 1 >= points.size()) {
      motion[k] = points[std::min(i, points.size() - 1)];
      continue;
    }
    const auto& a = points[i];
    const auto& b = points[i + 1];
    const auto between = model::hermite<double>({a.position, a.velocity}, {b.position, b.velocity}, s, spacing);
    motion[k] = {between.position, between.velocity, a.acceleration + s * (b.acceleration - a.acceleration)};
  }
  return motion;
}

}  // namespace

FootPointMotion road_from_file(const std::filesystem::path& file, double speed, double sample_rate, std::size_t samples,
                               RecordingReader read) {
  const Recording road = read_profile(file, speed, read);
  return motion_of(file, road, road.required(model::Channel::z_r, "is the road"), sample_rate, samples);
}

RoadOrCommand road_or_command(const std::filesystem::path& file, model::RigKind kind, double speed, double sample_rate,
                              std::size_t samples, RecordingReader read) {
  const Recording road = read_profile(file, speed, read);
  model::Channel channel = model::Channel::z_r;
  if (!road.has(channel)) {
    const bool car = kind == model::RigKind::quarter_car, bench = kind == model::RigKind::component_bench;
    if (car && road.has(model::Channel::z_cmd)) channel = model::Channel::z_cmd;
    if (bench && road.has(model::Channel::x_cmd)) channel = model::Channel::x_cmd;
    if (kind == model::RigKind::driven_mass && road.has(model::Channel::F)) channel = model::Channel::F;
  }
  return {motion_of(file, road, road.required(channel, "is the road"), sample_rate, samples),
          channel != model::Channel::z_r};
}

}  // namespace firmware
