#include "host_sim/manual/effect_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/text/run_stopped.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/identification/common/multisine.hpp"
#include "host_sim/identification/common/wording.hpp"
#include "host_sim/identification/report/diagnosis_report.hpp"
#include "host_sim/plan/effect_size.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "host_sim/report/report.hpp"

namespace host_sim::manual {
namespace {

constexpr std::array<const char*, 4> shipped{"paper_rig_fdva.toml", "paper_hil_fdva.toml", "paper_bench_fdva.toml",
                                             "paper_hil_aas.toml"};
constexpr std::size_t bench = 2;  // in `shipped`

// Of what is shown. The window begins where the start has died away, and is long enough for two cycles of the body.
constexpr double run_duration = 8.0, window_begin = 4.0, window_length = 1.5;  // [s]
// An effect that does nothing on the road is shown on this many times the road (the wheel must lift off), with limits
// of cylinder and sensors out of the way.
constexpr double rougher = 4.0;
constexpr double wide_stroke = 2.0, wide_speed = 10.0, wide_force = 1e6;  // [m], [m/s], [N]
constexpr double no_change = 1e-3;                                        // rms of the change ÷ rms
constexpr std::size_t longest_curve = 260;                                // points of a curve

/// A road and the run of a rig over it without effects.
struct Drive {
  std::string words;  ///< behind the values of an effect
  firmware::FootPointMotion motion;
  Run without;
};

/// A shipped rig without effects of its own.
struct PlainRig {
  std::string file;
  firmware::RigDescription description;
  std::unique_ptr<plan::Rehearsal> rehearsal;
  std::vector<plan::Subject> subjects;
  std::vector<Drive> drives;
};

Run drive(const firmware::RigDescription& description, const firmware::FootPointMotion& motion) {
  RunOptions options;
  options.noise = firmware::SimulatedRig::Noise::none;
  Run run = run_closed_loop(description, motion, options);
  if (firmware::is_fault(run.trip.reason)) {
    throw firmware::RunStopped(description.source +
                               ": the firmware stopped the run: " + std::string(firmware::name(run.trip.reason)));
  }
  return run;
}

PlainRig plain_rig(const std::filesystem::path& folder, const char* file) {
  PlainRig rig{file, firmware::read_rig((folder / file).string()), nullptr, {}, {}};
  firmware::RigDescription& description = rig.description;
  for (const firmware::PlacedEffect& effect : firmware::effects_of(description.rig)) {
    firmware::remove_effect(description.rig, *effect.entry, effect.channel);
  }
  const firmware::RoadChoice road{"iso8608:B", 27.78, 1, std::nullopt, std::nullopt};
  const std::size_t samples = firmware::samples_of(run_duration, description.sample_rate);
  firmware::FootPointMotion motion = firmware::excitation(
      description.rig, firmware::motion_over(road, description, samples, read_recording), description.sample_rate);

  // Sizes are found on a bench, where there is no body that a skyhook could hold still.
  firmware::RigDescription uncontrolled = description;
  uncontrolled.rig.air_spring.skyhook = 0.0;
  plan::Setting setting;
  setting.motion = motion;
  rig.rehearsal = std::make_unique<plan::Rehearsal>(uncontrolled, setting);
  rig.subjects = plan::subjects(*rig.rehearsal);

  description.range = {};
  description.controller.stroke = wide_stroke;
  description.controller.speed = wide_speed;
  description.controller.force = wide_force;
  rig.drives.push_back({"", motion, drive(description, motion)});
  identification::scale(motion, rougher);
  rig.drives.push_back(
      {", on a road " + report::figure_text(rougher, 2) + " times as high", motion, drive(description, motion)});
  return rig;
}

/// Every n-th sample of the window, so that a curve has at most longest_curve points.
std::vector<double> window_of(const std::vector<double>& column, std::size_t samples, double period) {
  const auto begin = std::min(static_cast<std::size_t>(std::lround(window_begin / period)), samples / 2);
  const auto end = std::min(samples, begin + static_cast<std::size_t>(std::lround(window_length / period)));
  const std::size_t step = (end - begin + longest_curve - 1) / longest_curve;
  std::vector<double> curve;
  for (std::size_t k = begin; k < end; k += step) curve.push_back(column[k]);
  return curve;
}

ChannelPicture channel_picture(model::Channel channel, const Run& without, const Run& with) {
  const std::vector<double>& a = without.recording.channels[index(channel)];
  const std::vector<double>& b = with.recording.channels[index(channel)];
  const std::size_t samples = std::min(a.size(), b.size());
  double change = 0.0, size = 0.0;
  for (std::size_t k = 0; k < samples; ++k) {
    change += (b[k] - a[k]) * (b[k] - a[k]);
    size += a[k] * a[k];
  }
  const double period = without.recording.sample_period;
  return {channel, size > 0.0 ? std::sqrt(change / size) : 0.0, window_of(a, samples, period),
          window_of(b, samples, period)};
}

std::string values_in_words(const firmware::PlacedEffect& effect) {
  std::string text = identification::words(effect);
  for (std::size_t p = 0; p < effect.values.size(); ++p) {
    text += (p == 0 ? ": " : ", ") + std::string(effect.entry->parameters[p].name) + " = " +
            report::figure_text(effect.values[p], 3);
    const std::string unit = identification::unit_of(effect, p);
    if (!unit.empty()) text += " " + unit;
  }
  return text;
}

EffectPicture picture_over(const Drive& road, const plan::Subject& subject, const PlainRig& rig) {
  const firmware::PlacedEffect effect = subject.placed();
  firmware::RigDescription description = rig.description;
  firmware::put_effect(description.rig, effect);
  const Run with = drive(description, road.motion);
  EffectPicture picture{subject.entry, rig.file, values_in_words(effect) + road.words, window_length};
  for (std::size_t c = 0; c < model::channel_count; ++c) {
    if (road.without.recording.channels[c].empty() || with.recording.channels[c].empty()) continue;
    picture.channels.push_back(channel_picture(model::channel_at(c), road.without, with));
  }
  return picture;
}

/// On the first road on which the effect changes something.
EffectPicture picture_of(const plan::Subject& subject, const PlainRig& rig) {
  EffectPicture picture;
  for (const Drive& road : rig.drives) {
    picture = picture_over(road, subject, rig);
    const auto changes = [](const ChannelPicture& channel) { return channel.change >= no_change; };
    if (std::any_of(picture.channels.begin(), picture.channels.end(), changes)) break;
  }
  return picture;
}

/// The law of an effect as a bench sees it; nullopt: it has no place there.
std::optional<ChannelPicture> force_on_bench(const firmware::PlacedEffect& effect, const PlainRig& rig) {
  if (!firmware::has_place(rig.description.rig, *effect.entry, effect.channel)) return std::nullopt;
  firmware::RigDescription description = rig.description;
  firmware::put_effect(description.rig, effect);
  const Drive& road = rig.drives.front();
  return channel_picture(model::Channel::F, road.without, drive(description, road.motion));
}

}  // namespace

std::vector<EffectPicture> effect_pictures(const std::filesystem::path& rigs) {
  std::vector<PlainRig> plain;
  for (const char* file : shipped) plain.push_back(plain_rig(rigs, file));
  std::vector<EffectPicture> pictures;
  for (const firmware::CatalogueEntry& entry : firmware::catalogue()) {
    const std::size_t before = pictures.size();
    for (const PlainRig& rig : plain) {
      const auto subject = std::find_if(rig.subjects.begin(), rig.subjects.end(), [&](const plan::Subject& s) {
        return s.entry == &entry && s.values.size() == entry.parameters.size() &&
               (!entry.of_channel || s.channel == model::Channel::F_w || s.channel == model::Channel::F);
      });
      if (subject == rig.subjects.end()) continue;
      pictures.push_back(picture_of(*subject, rig));
      const bool quarter_car = rig.description.rig.kind == model::RigKind::quarter_car;
      if (quarter_car && !entry.of_channel) pictures.back().on_bench = force_on_bench(subject->placed(), plain[bench]);
      break;
    }
    if (pictures.size() == before) {
      throw std::logic_error("effect " + std::string(entry.name) + " has a place on none of the shipped rigs");
    }
  }
  return pictures;
}

}  // namespace host_sim::manual
