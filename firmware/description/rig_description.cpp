#include "firmware/description/rig_description.hpp"

#include <cmath>

#include "firmware/description/calibration_reader.hpp"
#include "firmware/description/compensation_reader.hpp"
#include "firmware/description/compensation_setup.hpp"
#include "firmware/description/laws/law_file.hpp"
#include "firmware/description/laws/law_reader.hpp"
#include "firmware/description/recorder_reader.hpp"
#include "firmware/description/rig_description_controller.hpp"
#include "firmware/description/table/rig_description_table.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/text/small_text.hpp"
#include "firmware/description/values/extensions.hpp"

namespace firmware {
namespace {

using Rig = model::RigParameters<double>;

model::RigKind read_kind(DescriptionTable& top) {
  const std::string word = top.text("kind");
  for (std::size_t i = 0; i < model::rig_kind_names.size(); ++i) {
    if (model::rig_kind_names[i] != word) continue;
    const auto kind = static_cast<model::RigKind>(i);
    if (kind != model::RigKind::component_bench || !top.has("driven_by")) return kind;
    const std::string driver = top.text("driven_by");
    if (driver == "force") return model::RigKind::driven_mass;
    if (driver == "motion") return kind;
    top.fail("driven_by", "driven_by = " + in_quotes(driver) + " does not fit",
             "\"motion\" (x_cmd or x_act is the input) or \"force\" (F is)");
  }
  top.fail("kind", with_suggestion("unknown kind", word, model::rig_kind_names),
           "one of " + listed(model::rig_kind_names));
}

/// All tables of numbers. A component_bench may say on which car (body, wheel, tyre) its component drives:
/// excitation().
void read_parameters(DescriptionTable& top, Rig& rig) {
  const bool car = rig.kind == model::RigKind::quarter_car || rig.kind == model::RigKind::hil;
  const bool driven = rig.kind == model::RigKind::driven_mass;
  struct Part {
    std::string_view table;
    bool needed;
    std::string_view expected;
  };
  const std::array<Part, 6> parts{{
      {"body", car || driven, "a table [body] with mass, which this kind of rig has"},
      {"wheel", car, "a table [wheel] with mass, which this kind of rig has"},
      {"tyre", car, "a table [tyre] with stiffness and damping, which this kind of rig has"},
      {"suspension", true, "a table [suspension] with stiffness and damping"},
      {"machine", false, ""},
      {"fdva", false, ""},
  }};
  for (const Part& part : parts) {
    auto table = top.table(part.table);
    if (!table) {
      if (part.needed) top.need(part.table, part.expected);
      continue;
    }
    for (const auto& p : parameter_paths()) {
      if (p.table != part.table) continue;
      if (p.table == "machine") {
        table->optional_number(p.key, p.value(rig));
      } else {
        p.value(rig) = table->number(p.key);
      }
    }
    if (part.table == "machine") read_delay_variation(*table, rig);
    if (part.table == "fdva") {
      rig.has_fdva = true;
      rig.fdva.ducts = table->whole("ducts");
      rig.fdva.open_ducts = table->whole("open_ducts");
    }
    table->finish();
  }
}

template <class Slot>
void read_effect(DescriptionTable& parent, std::string_view name, Slot& slot) {
  using Effect = std::remove_cvref_t<decltype(slot.effect)>;
  auto table = parent.table(name);
  if (!table) return;
  slot.active = true;
  for (std::size_t i = 0; i < Effect::card.parameters.size(); ++i) {
    slot.effect.*Effect::values[i] = table->number(Effect::card.parameters[i].name);
  }
  table->finish();
}

void read_effects(DescriptionTable& top, Rig& rig) {
  auto effects = top.table("effects");
  if (!effects) return;
  rig.effects.for_each(
      [&](auto& slot) { read_effect(*effects, std::remove_cvref_t<decltype(slot.effect)>::card.name, slot); });
  // A sensor effect has one table for each channel, [effects.sensor_lag.dz_b].
  rig.effects.for_each_sensor([&](auto& slot, model::Channel channel) {
    auto channels = effects->table(std::remove_cvref_t<decltype(slot.effect)>::card.name);
    if (!channels) return;
    channels->for_each_channel([](model::Channel, const std::string&, const toml::node&) {});
    read_effect(*channels, model::name(channel), slot);
  });
  effects->finish();
}

void read_tolerances(DescriptionTable& top, RigDescription& description) {
  const auto table = top.table("tolerance");
  if (!table) return;
  std::vector<std::string> known;
  for (const auto& p : parameter_paths()) {
    if (has_part(description.rig, p.table)) known.push_back(std::string(p.table) + "." + std::string(p.key));
  }

  const auto take = [&](const std::string& path, const toml::node& node) {
    if (find_parameter(description.rig, path) == nullptr) {
      const std::vector<std::string_view> words(known.begin(), known.end());
      table->fail(node, with_suggestion("tolerance of the unknown parameter", path, words),
                  "a parameter of this rig, such as \"suspension.stiffness\"");
    }
    const auto value = as_number(node);
    if (!value || !(*value >= 0.0 && *value <= 10.0)) {
      table->fail(node, "the tolerance of " + path + " is not a number in 0 … 10",
                  "a relative bound, such as 0.03 for ±3 %");
    }
    description.tolerance[path] = *value;
  };
  const auto walk = [&](const auto& self, const toml::table& inner, const std::string& prefix) -> void {
    for (const auto& [key, node] : inner) {
      const std::string path = prefix + std::string(key.str());
      if (node.is_table()) {
        self(self, *node.as_table(), path + ".");
      } else {
        take(path, node);
      }
    }
  };
  walk(walk, table->raw(), "");
}

void read_sensors(DescriptionTable& top, RigDescription& description) {
  if (auto noise = top.table("noise")) {
    noise->for_each_channel([&](model::Channel channel, const std::string& key, const toml::node& node) {
      const double value = noise->number(key);
      if (value < 0.0) noise->fail(node, noise->path(key) + " is negative", "the rms of the channel's noise, >= 0");
      description.noise[model::index(channel)] = value;
    });
  }
  if (auto range = top.table("range")) {
    range->for_each_channel([&](model::Channel channel, const std::string& key, const toml::node& node) {
      const auto* pair = node.as_array();
      const bool two = pair != nullptr && pair->size() == 2;
      const auto lowest = two ? as_number((*pair)[0]) : std::nullopt;
      const auto highest = two ? as_number((*pair)[1]) : std::nullopt;
      if (!lowest || !highest || !(*lowest < *highest)) {
        range->fail(node, range->path(key) + " is not a range", "[lowest, highest] in SI units");
      }
      description.range[model::index(channel)] = {*lowest, *highest};
    });
  }
  if (auto channels = top.table("channels")) {
    for (const auto& [key, node] : channels->raw()) {
      const std::string name(key.str());
      if (!is_recorded_quantity(name)) {
        std::vector<std::string_view> names{"t"};
        for (const auto& n : model::channel_names) names.push_back(n.name);
        channels->fail(node, with_suggestion("unknown channel", channels->path(name), names),
                       "t, a channel or duct_1 … duct_6");
      }
      DescriptionTable entry = *channels->table(name);
      ColumnSource column;
      column.column = entry.text("column");
      if (entry.has("scale")) column.scale = entry.number("scale");
      entry.optional_number("offset", column.offset);
      if (column.scale == 0.0) entry.fail("scale", entry.path("scale") + " is 0", "a factor other than 0");
      entry.finish();
      description.channels[name] = column;
    }
    channels->accept_all_keys();
  }
}

/// [kg] Far beyond every rig: its square, and that of the force that moves it, are still numbers.
constexpr double largest_mass = 1e15;

/// A rig that the model refuses, at the line where the number stands.
void check_physics(const toml::table& top, const RigDescription& description) {
  Rig rig = description.rig;
  auto fault = find_rig_fault(rig, description.period());
  // A bench is commanded as a car on a road would deflect it, be that its own or the paper's.
  const bool drives_on_car = rig.kind == model::RigKind::component_bench;
  if (!fault && drives_on_car) fault = find_rig_fault(on_its_car(rig), description.period());
  if (!fault && !(rig.body.mass <= largest_mass)) fault = model::RigFault{"body", "mass", "a mass that a road moves"};
  if (!fault && !(rig.wheel.mass <= largest_mass)) fault = model::RigFault{"wheel", "mass", "a mass that a road moves"};
  if (!fault) return;
  const toml::node* node = &top;
  std::string path;
  const auto descend = [&](std::string_view key) {
    if (key.empty()) return;
    path += (path.empty() ? "" : ".") + std::string(key);
    const toml::table* table = node->as_table();
    const toml::node* inner = table != nullptr ? table->get(key) : nullptr;
    if (inner != nullptr) node = inner;
  };
  if (!fault->table.empty() && !top.contains(fault->table)) descend("effects");
  descend(fault->table);
  if (fault->channel) descend(model::name(*fault->channel));
  descend(fault->key);
  if (path.empty()) path = "the rig as a whole";
  if (const auto value = as_number(*node)) path += " = " + shortest(*value);
  std::string expected(fault->expected);
  if (fault->bounds) expected += ", " + shortest(fault->bounds->lower) + " to " + shortest(fault->bounds->upper);
  throw InputError(description.source, node == &top ? 0 : node->source().begin.line, path + " does not fit", expected);
}

/// The line of every key and table below a table.
void note_lines(const toml::table& table, const std::string& prefix,
                std::map<std::string, std::size_t, std::less<>>& lines) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix + std::string(key.str());
    lines[path] = node.source().begin.line;
    if (node.is_table()) note_lines(*node.as_table(), path + ".", lines);
  }
}

}  // namespace

std::size_t RigDescription::line_of(std::string_view path) const {
  for (;;) {
    if (const auto found = lines.find(path); found != lines.end()) return found->second;
    const std::size_t dot = path.rfind('.');
    if (dot == std::string_view::npos) return 0;
    path = path.substr(0, dot);
  }
}

std::string place(const RigDescription& description, const MotionObjection& objection) {
  const std::size_t line = objection.key.empty() ? 0 : description.line_of(objection.key);
  return line == 0 ? description.source : description.source + ":" + std::to_string(line);
}

std::optional<MeasuringRange> trusted_range(const RigDescription& description, std::size_t channel) {
  std::optional<MeasuringRange> range = description.range[channel];
  if (!range || !description.hardware.converters) return range;
  for (const auto& input : description.hardware.converters->inputs) {
    const double count = std::abs(input.scale);
    if (input.channel != channel || range->upper - range->lower <= 2.0 * count) continue;
    range->lower += 0.5 * count;
    range->upper -= 0.5 * count;
  }
  return range;
}

RigDescription parse_rig(std::string_view text, std::string_view source) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw InputError(source, 0, "the file is empty", "a rig description, beginning with kind and sample_rate");
  }
  toml::table top_table;
  try {
    top_table = toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    throw InputError(source, error.source().begin.line, "TOML syntax: " + std::string(error.description()),
                     "a rig description in TOML");
  }
  RigDescription description;
  description.source = source;
  description.text = text;
  note_lines(top_table, "", description.lines);
  DescriptionTable top(top_table, "", source);
  description.rig.kind = read_kind(top);
  description.sample_rate = top.number("sample_rate");
  if (!(description.sample_rate >= 1.0 && description.sample_rate <= 1e5)) {
    top.fail("sample_rate", "sample_rate = " + shortest(description.sample_rate) + " does not fit",
             "the rate of the loop in Hz, from 1 to 100000");
  }
  read_parameters(top, description.rig);
  read_air_spring(top, description.rig);
  read_lever(top, description.rig);
  read_effects(top, description.rig);
  description.laws = read_laws(top, description.rig);
  read_sensors(top, description);
  description.calibration = read_calibrations(top, description.rig);
  description.recorder = read_recorder(top, description.rig);
  read_waivers(top, description.waivers);
  read_controller(top, description.rig, description.sample_rate, description.controller);
  read_arming(top, description.waivers, description.controller);
  read_delay_budget(top, description.rig.kind, description.delay_budget);
  description.compensation = read_compensation(top, description.rig);
  read_hardware(top, description.rig, description.period(), description.waivers, description.hardware);
  check_stop_test(top, description);
  read_tolerances(top, description);
  top.finish();
  check_physics(top_table, description);
  if (description.compensation) static_cast<void>(compensation_settings(description));  // that its numbers fit
  check_load(top, description.rig);
  check_lever_tolerances(top, description.rig, description.tolerance);
  return description;
}

RigDescription read_rig(const std::filesystem::path& file) {
  return parse_rig(read_small_text(file, "a rig description in TOML"), file.string());
}

std::vector<std::filesystem::path> referenced_files(const RigDescription& description) {
  std::vector<std::filesystem::path> files;
  for (const LawDescription& law : description.laws) {
    if (law.file.empty()) continue;
    const std::filesystem::path file = law_file_path(description.source, law.file);
    if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(file);
  }
  return files;
}

}  // namespace firmware
