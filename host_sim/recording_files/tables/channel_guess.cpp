#include "host_sim/recording_files/tables/channel_guess.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

namespace host_sim {
namespace {

using model::Channel;

// What a word of a name says.
enum class Meaning : unsigned char {
  displacement,
  deflection,
  acceleration,
  velocity,
  force,
  wheel_force,
  road,
  wheel,
  body,
  tyre,
  suspension,
  actuator,
  command,
  actual,
  none_of_ours
};

enum class Match : unsigned char { word, begin, end, anywhere };

struct Word {
  std::string_view text;
  Match match;
  Meaning meaning;
};

// German and English, in lower case with ä ö ü ß as ae oe ue ss. Short words count only as whole words or as the begin
// of one ("Radweg"); a compound may hold several ("Aufbaubeschleunigung").
constexpr std::array known_words{
    Word{"weg", Match::begin, Meaning::displacement},
    Word{"weg", Match::end, Meaning::displacement},
    Word{"verschiebung", Match::anywhere, Meaning::displacement},
    Word{"position", Match::anywhere, Meaning::displacement},
    Word{"pos", Match::word, Meaning::displacement},
    Word{"auslenkung", Match::anywhere, Meaning::displacement},
    Word{"hub", Match::word, Meaning::displacement},
    Word{"kolbenhub", Match::anywhere, Meaning::displacement},
    Word{"displ", Match::begin, Meaning::displacement},
    Word{"disp", Match::word, Meaning::displacement},
    Word{"dist", Match::begin, Meaning::displacement},
    Word{"stroke", Match::anywhere, Meaning::displacement},
    Word{"travel", Match::anywhere, Meaning::displacement},
    Word{"length", Match::word, Meaning::displacement},
    Word{"lvdt", Match::begin, Meaning::displacement},
    Word{"extension", Match::anywhere, Meaning::displacement},
    Word{"stempel", Match::begin, Meaning::displacement},
    Word{"crosshead", Match::anywhere, Meaning::displacement},
    Word{"traverse", Match::anywhere, Meaning::displacement},
    Word{"einfederung", Match::anywhere, Meaning::deflection},
    Word{"federweg", Match::anywhere, Meaning::deflection},
    Word{"deflection", Match::anywhere, Meaning::deflection},
    Word{"defl", Match::word, Meaning::deflection},
    Word{"rattle", Match::word, Meaning::deflection},
    Word{"compression", Match::anywhere, Meaning::deflection},
    Word{"beschl", Match::anywhere, Meaning::acceleration},
    Word{"accel", Match::anywhere, Meaning::acceleration},
    Word{"acc", Match::word, Meaning::acceleration},
    Word{"acc", Match::end, Meaning::acceleration},
    Word{"geschw", Match::anywhere, Meaning::velocity},
    Word{"veloc", Match::anywhere, Meaning::velocity},
    Word{"vel", Match::word, Meaning::velocity},
    Word{"speed", Match::anywhere, Meaning::velocity},
    Word{"kraft", Match::anywhere, Meaning::force},
    Word{"kraefte", Match::anywhere, Meaning::force},
    Word{"force", Match::anywhere, Meaning::force},
    Word{"forc", Match::word, Meaning::force},
    Word{"load", Match::begin, Meaning::force},
    Word{"last", Match::word, Meaning::force},
    Word{"kmd", Match::word, Meaning::force},
    Word{"messdose", Match::anywhere, Meaning::force},
    Word{"loadcell", Match::anywhere, Meaning::force},
    Word{"radlast", Match::anywhere, Meaning::wheel_force},
    Word{"aufstandskraft", Match::anywhere, Meaning::wheel_force},
    Word{"wheelload", Match::anywhere, Meaning::wheel_force},
    Word{"contact", Match::word, Meaning::wheel_force},
    Word{"road", Match::begin, Meaning::road},
    Word{"strasse", Match::anywhere, Meaning::road},
    Word{"strassen", Match::anywhere, Meaning::road},
    Word{"fusspunkt", Match::anywhere, Meaning::road},
    Word{"foot", Match::begin, Meaning::road},
    Word{"ground", Match::word, Meaning::road},
    Word{"fahrbahn", Match::anywhere, Meaning::road},
    Word{"base", Match::word, Meaning::road},
    Word{"shaker", Match::begin, Meaning::road},
    Word{"platform", Match::begin, Meaning::road},
    Word{"plattform", Match::begin, Meaning::road},
    Word{"anregung", Match::end, Meaning::road},
    Word{"excitation", Match::word, Meaning::road},
    Word{"rad", Match::begin, Meaning::wheel},
    Word{"wheel", Match::begin, Meaning::wheel},
    Word{"achse", Match::anywhere, Meaning::wheel},
    Word{"axle", Match::word, Meaning::wheel},
    Word{"radtraeger", Match::anywhere, Meaning::wheel},
    Word{"unsprung", Match::anywhere, Meaning::wheel},
    Word{"ungefedert", Match::begin, Meaning::wheel},
    Word{"knuckle", Match::word, Meaning::wheel},
    Word{"aufbau", Match::begin, Meaning::body},
    Word{"body", Match::begin, Meaning::body},
    Word{"karosserie", Match::anywhere, Meaning::body},
    Word{"chassis", Match::word, Meaning::body},
    Word{"sprung", Match::word, Meaning::body},
    Word{"gefedert", Match::begin, Meaning::body},
    Word{"reifen", Match::begin, Meaning::tyre},
    Word{"tyre", Match::begin, Meaning::tyre},
    Word{"tire", Match::begin, Meaning::tyre},
    Word{"susp", Match::begin, Meaning::suspension},
    Word{"federbein", Match::anywhere, Meaning::suspension},
    Word{"daempfer", Match::anywhere, Meaning::suspension},
    Word{"damper", Match::anywhere, Meaning::suspension},
    Word{"strut", Match::word, Meaning::suspension},
    Word{"shock", Match::begin, Meaning::suspension},
    Word{"aktor", Match::anywhere, Meaning::actuator},
    Word{"aktuator", Match::anywhere, Meaning::actuator},
    Word{"actuator", Match::anywhere, Meaning::actuator},
    Word{"stellkraft", Match::anywhere, Meaning::actuator},
    Word{"soll", Match::begin, Meaning::command},
    Word{"soll", Match::end, Meaning::command},
    Word{"cmd", Match::word, Meaning::command},
    Word{"command", Match::begin, Meaning::command},
    Word{"ref", Match::word, Meaning::command},
    Word{"reference", Match::begin, Meaning::command},
    Word{"setpoint", Match::anywhere, Meaning::command},
    Word{"demand", Match::begin, Meaning::command},
    Word{"desired", Match::word, Meaning::command},
    Word{"target", Match::word, Meaning::command},
    Word{"fuehrungs", Match::begin, Meaning::command},
    Word{"vorgabe", Match::anywhere, Meaning::command},
    Word{"ist", Match::begin, Meaning::actual},
    Word{"ist", Match::word, Meaning::actual},
    Word{"actual", Match::begin, Meaning::actual},
    Word{"act", Match::word, Meaning::actual},
    Word{"feedback", Match::begin, Meaning::actual},
    Word{"fbk", Match::word, Meaning::actual},
    Word{"meas", Match::begin, Meaning::actual},
    Word{"gemessen", Match::anywhere, Meaning::actual},
    Word{"kolben", Match::begin, Meaning::actual},
    Word{"piston", Match::begin, Meaning::actual},
    Word{"zylinder", Match::begin, Meaning::actual},
    Word{"cylinder", Match::begin, Meaning::actual},
    Word{"error", Match::begin, Meaning::none_of_ours},
    Word{"fehler", Match::anywhere, Meaning::none_of_ours},
    Word{"abweichung", Match::anywhere, Meaning::none_of_ours},
    Word{"min", Match::word, Meaning::none_of_ours},
    Word{"max", Match::word, Meaning::none_of_ours},
    Word{"limit", Match::anywhere, Meaning::none_of_ours},
    Word{"grenz", Match::begin, Meaning::none_of_ours},
    Word{"peak", Match::begin, Meaning::none_of_ours},
    Word{"valley", Match::begin, Meaning::none_of_ours},
    Word{"count", Match::begin, Meaning::none_of_ours},
    Word{"segments", Match::word, Meaning::none_of_ours},
    Word{"temp", Match::begin, Meaning::none_of_ours},
    Word{"status", Match::anywhere, Meaning::none_of_ours},
    Word{"torque", Match::anywhere, Meaning::none_of_ours},
    Word{"drehmoment", Match::anywhere, Meaning::none_of_ours},
    Word{"rain", Match::begin, Meaning::none_of_ours},
    Word{"regen", Match::begin, Meaning::none_of_ours},
    Word{"precipitation", Match::anywhere, Meaning::none_of_ours},
    Word{"niederschlag", Match::anywhere, Meaning::none_of_ours},
};

struct Abbreviation {
  std::string_view text;  // letters and digits of the name, in lower case
  Channel channel;
};

// Names of the textbooks: Mitschke (z_A, z_R), Savaresi et al. (z, z_t, z_r), Rajamani (z_s, z_u, z_r), Simulink
// models.
constexpr std::array abbreviations{
    Abbreviation{"zr", Channel::z_r},      Abbreviation{"zroad", Channel::z_r},   Abbreviation{"xr", Channel::z_r},
    Abbreviation{"zw", Channel::z_w},      Abbreviation{"zu", Channel::z_w},      Abbreviation{"zus", Channel::z_w},
    Abbreviation{"xu", Channel::z_w},      Abbreviation{"xus", Channel::z_w},     Abbreviation{"zwheel", Channel::z_w},
    Abbreviation{"zb", Channel::z_b},      Abbreviation{"zs", Channel::z_b},      Abbreviation{"xs", Channel::z_b},
    Abbreviation{"zbody", Channel::z_b},   Abbreviation{"zddr", Channel::zdd_r},  Abbreviation{"zrdd", Channel::zdd_r},
    Abbreviation{"ddzr", Channel::zdd_r},  Abbreviation{"zddw", Channel::zdd_w},  Abbreviation{"zwdd", Channel::zdd_w},
    Abbreviation{"ddzw", Channel::zdd_w},  Abbreviation{"zudd", Channel::zdd_w},  Abbreviation{"zusdd", Channel::zdd_w},
    Abbreviation{"ddzu", Channel::zdd_w},  Abbreviation{"zddb", Channel::zdd_b},  Abbreviation{"zbdd", Channel::zdd_b},
    Abbreviation{"ddzb", Channel::zdd_b},  Abbreviation{"zsdd", Channel::zdd_b},  Abbreviation{"ddzs", Channel::zdd_b},
    Abbreviation{"aw", Channel::zdd_w},    Abbreviation{"ab", Channel::zdd_b},    Abbreviation{"dzw", Channel::dz_w},
    Abbreviation{"dzb", Channel::dz_b},    Abbreviation{"fw", Channel::F_w},      Abbreviation{"fz", Channel::F_w},
    Abbreviation{"fzdyn", Channel::F_w},   Abbreviation{"fdyn", Channel::F_w},    Abbreviation{"xcmd", Channel::x_cmd},
    Abbreviation{"xsoll", Channel::x_cmd}, Abbreviation{"xref", Channel::x_cmd},  Abbreviation{"xdes", Channel::x_cmd},
    Abbreviation{"ssoll", Channel::x_cmd}, Abbreviation{"xact", Channel::x_act},  Abbreviation{"xist", Channel::x_act},
    Abbreviation{"xmeas", Channel::x_act}, Abbreviation{"sist", Channel::x_act},  Abbreviation{"xfb", Channel::x_act},
    Abbreviation{"f", Channel::F},         Abbreviation{"fist", Channel::F},      Abbreviation{"fd", Channel::F},
    Abbreviation{"fact", Channel::F_act},  Abbreviation{"zcmd", Channel::z_cmd},  Abbreviation{"accs", Channel::zdd_b},
    Abbreviation{"accu", Channel::zdd_w},  Abbreviation{"accus", Channel::zdd_w}, Abbreviation{"defs", Channel::dz_b},
    Abbreviation{"deft", Channel::dz_w},
};

// Lower case, umlauts as two letters, words separated by single blanks; a change to upper case begins a word.
std::string folded(std::string_view name) {
  std::string text;
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> letters{
      {{"ä", "ae"}, {"ö", "oe"}, {"ü", "ue"}, {"ß", "ss"}, {"Ä", "Ae"}, {"Ö", "Oe"}, {"Ü", "Ue"}}};
  for (std::size_t i = 0; i < name.size();) {
    const auto* letter = std::find_if(letters.begin(), letters.end(),
                                      [&](const auto& known) { return name.substr(i).starts_with(known.first); });
    if (letter != letters.end()) {
      text += letter->second;
      i += letter->first.size();
    } else {
      text += name[i++];
    }
  }
  std::string result;
  char before = ' ';
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool letter_or_digit = std::isalnum(byte) != 0;
    if (std::isupper(byte) != 0 && std::islower(static_cast<unsigned char>(before)) != 0) result += ' ';
    if (letter_or_digit) {
      result += static_cast<char>(std::tolower(byte));
    } else if (!result.empty() && result.back() != ' ') {
      result += ' ';
    }
    before = c;
  }
  while (!result.empty() && result.back() == ' ') result.pop_back();
  return result;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> result;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (end > 0) result.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

bool matches(const Word& word, std::string_view in_name) {
  switch (word.match) {
    case Match::word:
      return in_name == word.text;
    case Match::begin:
      return in_name.starts_with(word.text);
    case Match::end:
      return in_name.ends_with(word.text);
    case Match::anywhere:
      return in_name.find(word.text) != std::string_view::npos;
  }
  return false;
}

struct Reading {
  std::array<std::string_view, 15> found{};  // by Meaning: the word in the name
  int words = 0;

  [[nodiscard]] bool has(Meaning meaning) const { return !found[static_cast<std::size_t>(meaning)].empty(); }
};

Reading read_words(std::string_view text) {
  Reading reading;
  for (const std::string_view in_name : words_of(text)) {
    for (const Word& word : known_words) {
      if (!matches(word, in_name) || reading.has(word.meaning)) continue;
      reading.found[static_cast<std::size_t>(word.meaning)] = word.text;
      ++reading.words;
    }
  }
  return reading;
}

bool is_place(const Reading& reading) {
  return reading.has(Meaning::road) || reading.has(Meaning::wheel) || reading.has(Meaning::body) ||
         reading.has(Meaning::wheel_force) || reading.has(Meaning::tyre);
}

std::optional<Channel> abbreviated(std::string_view text) {
  std::string letters;
  for (const char c : text) {
    if (c != ' ') letters += c;
  }
  for (const Abbreviation& known : abbreviations) {
    if (known.text == letters) return known.channel;
  }
  return std::nullopt;
}

// Kind of the quantity from unit and words; nullopt where they disagree or say nothing.
std::optional<firmware::Dimension> kind_of_quantity(const Reading& reading, std::optional<firmware::Dimension> unit) {
  std::optional<firmware::Dimension> by_words;
  if (reading.has(Meaning::force) || reading.has(Meaning::wheel_force)) by_words = firmware::Dimension::force;
  if (!by_words && reading.has(Meaning::acceleration)) by_words = firmware::Dimension::acceleration;
  if (!by_words && reading.has(Meaning::velocity)) by_words = firmware::Dimension::velocity;
  if (!by_words && (reading.has(Meaning::displacement) || reading.has(Meaning::deflection)))
    by_words = firmware::Dimension::length;
  if (!unit || *unit == firmware::Dimension::none) return by_words;
  // "Weg" of a force sensor in kN is a force: the unit is nearer to the numbers. Not so where both are clear and
  // differ.
  if (by_words && *by_words != *unit) return std::nullopt;
  return unit;
}

std::optional<Channel> displacement(const Reading& reading, model::RigKind kind) {
  const bool deflects = reading.has(Meaning::deflection);
  if (kind == model::RigKind::driven_mass) {
    return reading.has(Meaning::command) ? std::nullopt : std::optional(Channel::x_act);
  }
  if (kind != model::RigKind::component_bench) {
    if (reading.has(Meaning::tyre) && deflects) return Channel::dz_w;
    const bool of_suspension = reading.has(Meaning::suspension);
    const bool machine = kind == model::RigKind::hil && (reading.has(Meaning::command) || reading.has(Meaning::actual));
    if (!machine && (deflects || of_suspension) && !reading.has(Meaning::tyre)) return Channel::dz_b;
    const int places = static_cast<int>(reading.has(Meaning::road)) + static_cast<int>(reading.has(Meaning::wheel)) +
                       static_cast<int>(reading.has(Meaning::body));
    if (places == 1) {
      if (reading.has(Meaning::road)) return Channel::z_r;
      return reading.has(Meaning::wheel) ? Channel::z_w : Channel::z_b;
    }
    if (places > 1 || kind == model::RigKind::quarter_car) return std::nullopt;
  }
  return reading.has(Meaning::command) ? Channel::x_cmd : Channel::x_act;
}

std::optional<Channel> force(const Reading& reading, model::RigKind kind) {
  if (kind == model::RigKind::driven_mass) return Channel::F;  // measured or commanded: it is the input
  if (reading.has(Meaning::command)) return std::nullopt;      // the force is measured
  const bool says_force = reading.has(Meaning::force) || reading.has(Meaning::wheel_force);
  if (!says_force && reading.has(Meaning::road))
    return std::nullopt;  // an excitation in newtons is a shaker's or a hammer's
  if (kind == model::RigKind::component_bench) return Channel::F;
  const bool at_the_wheel = reading.has(Meaning::wheel_force) || reading.has(Meaning::wheel) ||
                            reading.has(Meaning::tyre) || reading.has(Meaning::road);
  if (at_the_wheel) return Channel::F_w;
  if (kind == model::RigKind::hil) return Channel::F;
  if (reading.has(Meaning::actuator)) return Channel::F_act;
  if (reading.has(Meaning::suspension) || reading.has(Meaning::body)) return std::nullopt;
  return Channel::F_w;
}

std::string reason_of(const Reading& reading, firmware::Dimension dimension, bool unit_known) {
  constexpr std::array<std::string_view, 15> meanings{
      "a displacement",    "a deflection",   "an acceleration", "a velocity",  "a force",
      "a wheel load",      "of the road",    "of the wheel",    "of the body", "of the tyre",
      "of the suspension", "of an actuator", "commanded",       "reached",     ""};
  std::string reason;
  for (std::size_t i = 0; i < reading.found.size(); ++i) {
    if (reading.found[i].empty()) continue;
    reason += (reason.empty() ? "'" : ", '") + std::string(reading.found[i]) + "': " + std::string(meanings[i]);
  }
  if (unit_known) reason += (reason.empty() ? "a unit of " : ", unit of ") + std::string(firmware::si_unit(dimension));
  return reason;
}

bool exists_on(Channel channel, model::RigKind kind) {
  const bool of_machine = channel == Channel::x_cmd || channel == Channel::x_act || channel == Channel::F;
  if (kind == model::RigKind::component_bench) return of_machine;
  if (kind == model::RigKind::driven_mass) {
    return channel == Channel::F || channel == Channel::x_act || channel == Channel::zdd_b;
  }
  if (kind == model::RigKind::quarter_car) return !of_machine;
  return channel != Channel::F_act && channel != Channel::z_cmd;
}

// Names of a data logger's inputs: words that mean nothing, numbers, single letters.
bool says_nothing(std::string_view text) {
  constexpr std::array<std::string_view, 24> words{"channel", "kanal",  "ch",     "chan",   "sensor",  "signal",
                                                   "input",   "analog", "ai",     "in",     "data",    "daten",
                                                   "value",   "wert",   "values", "column", "spalte",  "col",
                                                   "raw",     "mod",    "dev",    "slot",   "eingang", "messwert"};
  const std::vector<std::string_view> in_name = words_of(text);
  return std::all_of(in_name.begin(), in_name.end(), [&](std::string_view word) {
    while (!word.empty() && std::isdigit(static_cast<unsigned char>(word.back())) != 0) word.remove_suffix(1);
    return word.size() <= 2 || std::find(words.begin(), words.end(), word) != words.end();
  });
}

firmware::Quantity quantity_of(Channel channel) { return 1 + model::index(channel); }

}  // namespace

bool names_a_signal(std::string_view name) {
  const std::string text = folded(name);
  return abbreviated(text).has_value() || read_words(text).words > 0;
}

bool names_a_place(std::string_view name) {
  const std::string text = folded(name);
  if (const std::optional<Channel> channel = abbreviated(text)) {
    return exists_on(*channel, model::RigKind::quarter_car) && *channel != Channel::F_act;
  }
  return is_place(read_words(text));
}

std::optional<ChannelGuess> guess_channel(std::string_view name, std::optional<firmware::Dimension> dimension,
                                          std::optional<model::RigKind> kind) {
  // Of a path ("Model Root/Plant/Weg Rad") the last part names the signal.
  if (const std::size_t stroke = name.find_last_of("/\\");
      stroke != std::string_view::npos && stroke + 1 < name.size()) {
    if (const auto guess = guess_channel(name.substr(stroke + 1), dimension, kind)) return guess;
  }
  const std::string text = folded(name);
  const Reading reading = read_words(text);
  if (reading.has(Meaning::none_of_ours)) return std::nullopt;
  const model::RigKind rig =
      kind.value_or(is_place(reading) ? model::RigKind::quarter_car : model::RigKind::component_bench);

  if (const std::optional<Channel> channel = abbreviated(text)) {
    const firmware::Quantity quantity = quantity_of(*channel);
    const bool fits =
        !dimension || *dimension == firmware::Dimension::none || *dimension == firmware::dimension_of(quantity);
    if (fits && (!kind || exists_on(*channel, *kind)))
      return ChannelGuess{quantity, "'" + text + "' abbreviates it", 3};
  }

  const std::optional<firmware::Dimension> of = kind_of_quantity(reading, dimension);
  if (!of || (reading.words == 0 && !says_nothing(text))) return std::nullopt;
  std::optional<Channel> channel;
  if (*of == firmware::Dimension::length) channel = displacement(reading, rig);
  if (*of == firmware::Dimension::force) channel = force(reading, rig);
  if (*of == firmware::Dimension::acceleration && rig != model::RigKind::component_bench) {
    const bool one_mass = rig == model::RigKind::driven_mass;
    if (!one_mass && reading.has(Meaning::wheel)) {
      channel = Channel::zdd_w;
    } else if (one_mass || reading.has(Meaning::body)) {
      channel = Channel::zdd_b;
    } else if (reading.has(Meaning::road)) {
      channel = Channel::zdd_r;
    }
  }
  if (!channel || !exists_on(*channel, rig)) return std::nullopt;
  return ChannelGuess{quantity_of(*channel), reason_of(reading, *of, dimension.has_value()), reading.words};
}

bool is_time_name(std::string_view name) {
  constexpr std::array<std::string_view, 23> names{
      "x value",  "t",       "time",     "zeit",      "tout",  "timestamp",  "time stamp",   "zeitstempel",
      "uhrzeit",  "elapsed", "clock",    "date time", "datum", "datetime",   "messzeit",     "time axis",
      "laufzeit", "sec",     "abs time", "zeitachse", "date",  "datum zeit", "datum uhrzeit"};
  const std::string text = folded(name);
  if (std::find(names.begin(), names.end(), text) != names.end()) return true;
  const std::vector<std::string_view> in_name = words_of(text);
  return std::any_of(in_name.begin(), in_name.end(), [](std::string_view word) {
    while (!word.empty() && std::isdigit(static_cast<unsigned char>(word.back())) != 0) word.remove_suffix(1);
    return word == "time" || word == "zeit" || word == "timestamp" || word == "elapsed" || word == "uhrzeit";
  });
}

bool is_sample_number_name(std::string_view name) {
  constexpr std::array<std::string_view, 20> names{
      "count", "counter",   "sample index", "sample", "samples",     "sample number", "sample no",
      "index", "idx",       "nr",           "no",     "n",           "scan",          "row",
      "zeile", "messpunkt", "lfd nr",       "punkt",  "scan number", "sample nr"};
  const std::string text = folded(name);
  return std::find(names.begin(), names.end(), text) != names.end() || name == "#";
}

}  // namespace host_sim
