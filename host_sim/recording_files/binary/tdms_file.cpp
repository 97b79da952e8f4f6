#include "host_sim/recording_files/binary/tdms_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "firmware/description/text/input_error.hpp"

namespace host_sim {
namespace {

using firmware::InputError;

constexpr std::string_view a_whole_tdms_file = "a whole NI TDMS file";
constexpr std::uint32_t no_raw_data = 0xffffffff;
constexpr std::uint32_t same_raw_data = 0;
constexpr std::uint32_t daqmx_changing = 0x00001269;
constexpr std::uint32_t daqmx_digital = 0x00001369;
constexpr std::uint64_t until_the_end = ~std::uint64_t{0};
constexpr std::size_t lead_in_size = 28;
constexpr std::size_t most_tdms_objects = 100000;

enum Contents : std::uint32_t {
  meta_data = 1U << 1U,
  new_object_list = 1U << 2U,
  raw_data = 1U << 3U,
  interleaved = 1U << 5U,
  big_endian_data = 1U << 6U,
  daqmx_raw_data = 1U << 7U,
};

enum DataType : std::uint32_t {
  type_i8 = 1,
  type_i16 = 2,
  type_i32 = 3,
  type_i64 = 4,
  type_u8 = 5,
  type_u16 = 6,
  type_u32 = 7,
  type_u64 = 8,
  type_single = 9,
  type_double = 10,
  type_single_with_unit = 0x19,
  type_double_with_unit = 0x1a,
  type_string = 0x20,
  type_boolean = 0x21,
  type_time_stamp = 0x44,
  type_complex_single = 0x08000c,
  type_complex_double = 0x10000d,
};

// Bytes of one value; 0: of no fixed size or not known.
std::size_t size_of(std::uint32_t type) {
  switch (type) {
    case type_i8:
    case type_u8:
    case type_boolean:
      return 1;
    case type_i16:
    case type_u16:
      return 2;
    case type_i32:
    case type_u32:
    case type_single:
    case type_single_with_unit:
      return 4;
    case type_i64:
    case type_u64:
    case type_double:
    case type_double_with_unit:
    case type_complex_single:
      return 8;
    case type_time_stamp:
    case type_complex_double:
      return 16;
    default:
      return 0;
  }
}

// A cursor over the bytes that never leaves them.
class Bytes {
 public:
  Bytes(std::string_view bytes, std::string_view source) : bytes_(bytes), source_(source) {}

  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }
  void go_to(std::size_t at) { at_ = at; }
  void set_big_endian(bool big) { big_endian_ = big; }
  [[nodiscard]] bool holds(std::uint64_t count) const { return count <= bytes_.size() - std::min(at_, bytes_.size()); }

  std::uint64_t number(std::size_t size) {
    const unsigned char* p = take(size);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8U | p[big_endian_ ? i : size - 1 - i];
    return value;
  }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::string text() {
    const std::uint32_t length = u32();
    const auto* p = reinterpret_cast<const char*>(take(length));
    return {p, length};
  }
  const unsigned char* take(std::uint64_t size) {
    if (!holds(size))
      throw InputError(source_, 0, "the file breaks off at byte " + std::to_string(at_), a_whole_tdms_file);
    const auto* p = reinterpret_cast<const unsigned char*>(bytes_.data()) + at_;
    at_ += static_cast<std::size_t>(size);
    return p;
  }
  [[noreturn]] void fail(const std::string& wrong) const {
    throw InputError(source_, 0, "the file is damaged at byte " + std::to_string(at_) + ": " + wrong,
                     a_whole_tdms_file);
  }

 private:
  std::string_view bytes_;
  std::string_view source_;
  std::size_t at_ = 0;
  bool big_endian_ = false;
};

// One number of a fixed size, from bits in host order.
double as_number(std::uint32_t type, std::uint64_t bits) {
  switch (type) {
    case type_i8:
      return static_cast<std::int8_t>(bits);
    case type_i16:
      return static_cast<std::int16_t>(bits);
    case type_i32:
      return static_cast<std::int32_t>(bits);
    case type_i64:
      return static_cast<double>(static_cast<std::int64_t>(bits));
    case type_single:
    case type_single_with_unit:
      return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    case type_double:
    case type_double_with_unit:
      return std::bit_cast<double>(bits);
    default:
      return static_cast<double>(bits);
  }
}

class Parser {
 public:
  Parser(std::string_view bytes, std::string_view source) : bytes_(bytes, source) {}

  TdmsFile run() {
    if (bytes_.size() < lead_in_size) bytes_.fail("there is no segment");
    while (bytes_.at() < bytes_.size()) {
      if (!bytes_.holds(lead_in_size)) {
        file_.cut_off = true;
        break;
      }
      read_segment();
    }
    for (Object& object : objects_) finish(object);
    return std::move(file_);
  }

 private:
  struct Object {
    std::string path;
    std::size_t channel = 0;  // in file_.channels; valid if is_channel
    bool is_channel = false;
    bool has_index = false;
    std::uint32_t type = 0;
    std::uint64_t count = 0;      // values in a chunk
    std::uint64_t text_size = 0;  // bytes in a chunk
    bool daqmx = false;
    struct Scaler {
      std::uint32_t type, buffer, offset, id;
    };
    std::vector<Scaler> scalers{};        // of DAQmx raw data
    std::vector<std::uint32_t> widths{};  // bytes of a sample in each raw buffer
    std::uint32_t scaler_id = 0;          // of the values in the channel
  };

  void read_segment() {
    const std::size_t begin = bytes_.at();
    bytes_.set_big_endian(false);
    if (std::memcmp(bytes_.take(4), "TDSm", 4) != 0) bytes_.fail("no segment begins there");
    const std::uint32_t contents = bytes_.u32();
    bytes_.set_big_endian((contents & big_endian_data) != 0);
    bytes_.u32();  // version
    const std::uint64_t next = bytes_.number(8);
    const std::uint64_t raw = bytes_.number(8);
    std::size_t end = bytes_.size();
    const std::uint64_t room = bytes_.size() - begin - lead_in_size;
    if (next == until_the_end || next > room) {
      file_.cut_off = true;  // the program that wrote it was stopped
    } else {
      end = begin + lead_in_size + static_cast<std::size_t>(next);
    }
    if (raw > end - begin - lead_in_size) {
      if (!file_.cut_off) bytes_.fail("the raw data begin behind the segment");
      bytes_.go_to(bytes_.size());
      return;
    }
    if ((contents & meta_data) != 0) read_meta_data((contents & new_object_list) != 0);
    if ((contents & raw_data) != 0) {
      bytes_.go_to(begin + lead_in_size + static_cast<std::size_t>(raw));
      read_raw_data(end, (contents & interleaved) != 0, (contents & daqmx_raw_data) != 0,
                    (contents & big_endian_data) != 0);
    }
    bytes_.go_to(end);
  }

  std::size_t object_at(const std::string& path) {
    const auto found = by_path_.find(path);
    if (found != by_path_.end()) return found->second;
    if (objects_.size() >= most_tdms_objects) bytes_.fail("too many objects");
    Object object;
    object.path = path;
    const std::vector<std::string> parts = parts_of(path);
    if (parts.size() == 2) {
      object.is_channel = true;
      object.channel = file_.channels.size();
      file_.channels.push_back({parts[0], parts[1], {}, {}});
    }
    objects_.push_back(std::move(object));
    by_path_.emplace(path, objects_.size() - 1);
    return objects_.size() - 1;
  }

  // "/'Group'/'Channel'": parts in single quotes, a quote inside is doubled.
  static std::vector<std::string> parts_of(const std::string& path) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i + 1 < path.size() && path[i] == '/' && path[i + 1] == '\'';) {
      std::string part;
      for (i += 2; i < path.size(); ++i) {
        if (path[i] == '\'') {
          if (i + 1 >= path.size() || path[i + 1] != '\'') break;
          ++i;
        }
        part += path[i];
      }
      parts.push_back(std::move(part));
      ++i;
    }
    return parts;
  }

  void read_meta_data(bool new_list) {
    if (new_list) active_.clear();
    const std::uint32_t count = bytes_.u32();
    if (!bytes_.holds(std::uint64_t{count} * 12)) bytes_.fail("more objects than bytes");
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::size_t index = object_at(bytes_.text());
      read_index(index);
      read_properties(index);
    }
  }

  void read_index(std::size_t index) {
    Object& object = objects_[index];
    const std::uint32_t length = bytes_.u32();
    const auto listed = std::find(active_.begin(), active_.end(), index);
    if (length == no_raw_data) {
      if (listed != active_.end()) active_.erase(listed);
      return;
    }
    if (listed == active_.end()) active_.push_back(index);
    if (length == same_raw_data) {
      if (!object.has_index) bytes_.fail("an object repeats an index that it never had");
      return;
    }
    object.has_index = true;
    object.daqmx = length == daqmx_changing || length == daqmx_digital;
    object.type = bytes_.u32();
    bytes_.u32();  // dimension, always 1
    object.count = bytes_.number(8);
    if (object.daqmx) {
      // Scalers of 20 bytes (digital lines: 17), then the widths of the raw buffers.
      object.scalers.clear();
      object.widths.clear();
      const std::uint32_t scalers = bytes_.u32();
      const bool digital = length == daqmx_digital;
      if (!bytes_.holds(std::uint64_t{scalers} * (digital ? 17 : 20))) bytes_.fail("more scalers than bytes");
      for (std::uint32_t k = 0; k < scalers; ++k) {
        Object::Scaler scaler{};
        scaler.type = bytes_.u32();
        scaler.buffer = bytes_.u32();
        scaler.offset = bytes_.u32();
        bytes_.number(digital ? 1 : 4);  // format of the sample
        scaler.id = bytes_.u32();
        object.scalers.push_back(scaler);
      }
      const std::uint32_t widths = bytes_.u32();
      if (!bytes_.holds(std::uint64_t{widths} * 4)) bytes_.fail("more raw buffers than bytes");
      for (std::uint32_t k = 0; k < widths; ++k) object.widths.push_back(bytes_.u32());
      if (digital) object.scalers.clear();
      return;
    }
    if (object.type == type_string) object.text_size = bytes_.number(8);
  }

  void read_properties(std::size_t index) {
    const std::uint32_t count = bytes_.u32();
    for (std::uint32_t i = 0; i < count; ++i) {
      std::string name = bytes_.text();
      TdmsValue value = read_value(bytes_.u32());
      const Object& object = objects_[index];
      if (object.is_channel) {
        file_.channels[object.channel].properties[name] = std::move(value);
      } else if (object.path == "/") {
        file_.properties[name] = std::move(value);
      } else if (const std::vector<std::string> parts = parts_of(object.path); parts.size() == 1) {
        file_.groups[parts[0]][name] = std::move(value);
      }
    }
  }

  TdmsValue read_value(std::uint32_t type) {
    if (type == type_string) return {false, 0.0, bytes_.text()};
    const std::size_t size = size_of(type);
    if (size == 0) bytes_.fail("a property of an unknown type " + std::to_string(type));
    if (type == type_time_stamp) {
      const auto [seconds, fraction] = read_time_stamp();
      return {true, static_cast<double>(seconds) + fraction};
    }
    if (size == 16 || type == type_complex_single) {
      bytes_.take(size);
      return {};
    }
    return {true, as_number(type, bytes_.number(size))};
  }

  // Fractions of 2⁻⁶⁴ s and whole seconds since 1904-01-01; a big-endian file has them the other way round.
  std::pair<std::int64_t, double> read_time_stamp() {
    std::uint64_t fraction = bytes_.number(8);
    std::uint64_t seconds = bytes_.number(8);
    if (segment_is_big_endian_) std::swap(fraction, seconds);
    return {static_cast<std::int64_t>(seconds), std::ldexp(static_cast<double>(fraction), -64)};
  }

  static std::uint64_t bytes_in_chunk(const Object& object) {
    return object.type == type_string ? object.text_size : object.count * size_of(object.type);
  }

  void read_raw_data(std::size_t end, bool is_interleaved, bool is_daqmx, bool is_big_endian) {
    segment_is_big_endian_ = is_big_endian;
    std::vector<std::size_t> objects;
    std::uint64_t chunk = 0;
    if (is_daqmx) return read_daqmx(end);
    bool readable = true;
    for (const std::size_t index : active_) {
      const Object& object = objects_[index];
      if (!object.has_index) continue;
      objects.push_back(index);
      if (object.daqmx || (object.type != type_string && size_of(object.type) == 0)) readable = false;
      if (object.count > bytes_.size() || object.text_size > bytes_.size()) bytes_.fail("more samples than bytes");
      chunk += bytes_in_chunk(object);
    }
    if (!readable) {
      for (const std::size_t index : objects) mark_unreadable(objects_[index], "an unknown type");
      return;
    }
    const std::uint64_t room = end - bytes_.at();
    if (chunk == 0) return;
    const std::uint64_t chunks = room / chunk;
    if (room % chunk != 0) file_.cut_off = true;
    for (std::uint64_t c = 0; c < chunks; ++c) {
      is_interleaved ? read_interleaved(objects) : read_contiguous(objects);
    }
    if (room % chunk == 0) return;
    // The program that wrote it was stopped within a chunk: whole rows, or what each channel has in its turn.
    if (is_interleaved) {
      std::uint64_t row = 0;
      for (const std::size_t index : objects) row += size_of(objects_[index].type);
      for (std::uint64_t k = 0; row > 0 && k < room % chunk / row; ++k) {
        for (const std::size_t index : objects) read_sample(objects_[index]);
      }
      return;
    }
    for (const std::size_t index : objects) {
      Object& object = objects_[index];
      if (object.type == type_string || !object.is_channel) return;
      const std::uint64_t size = size_of(object.type);
      for (std::uint64_t k = 0; k < object.count; ++k) {
        if (end - bytes_.at() < size) return;
        read_sample(object);
      }
    }
  }

  static std::size_t size_of_scaler(std::uint32_t type) {
    constexpr std::array<std::size_t, 6> sizes{1, 1, 2, 2, 4, 4};  // u8, i8, u16, i16, u32, i32
    return type < sizes.size() ? sizes[type] : 0;
  }

  static double scaler_number(std::uint32_t type, std::uint64_t bits) {
    constexpr std::array<std::uint32_t, 6> types{type_u8, type_i8, type_u16, type_i16, type_u32, type_i32};
    return as_number(types[type], bits);
  }

  // DAQmx raw data: a chunk is one raw buffer after the other; in a buffer a sample of all its channels after the
  // other, each at its byte offset.
  void read_daqmx(std::size_t end) {
    std::vector<Object*> objects;
    std::vector<std::uint32_t> widths;
    std::vector<std::uint64_t> counts;
    for (const std::size_t index : active_) {
      Object& object = objects_[index];
      if (!object.has_index) continue;
      if (!object.daqmx || object.scalers.empty()) {
        mark_unreadable(object, "DAQmx raw data of digital lines");
        if (object.widths.empty()) continue;
      }
      if (object.count > bytes_.size()) bytes_.fail("more samples than bytes");
      if (widths.size() < object.widths.size()) {
        widths.resize(object.widths.size());
        counts.resize(object.widths.size());
      }
      for (std::size_t b = 0; b < object.widths.size(); ++b) widths[b] = object.widths[b];
      for (const Object::Scaler& scaler : object.scalers) {
        if (scaler.buffer >= widths.size() || size_of_scaler(scaler.type) == 0 ||
            scaler.offset > widths[scaler.buffer] ||
            widths[scaler.buffer] - scaler.offset < size_of_scaler(scaler.type))
          bytes_.fail("a DAQmx scaler outside its buffer");
        counts[scaler.buffer] = std::max(counts[scaler.buffer], object.count);
      }
      if (!object.scalers.empty()) objects.push_back(&object);
    }
    std::uint64_t chunk = 0;
    for (std::size_t b = 0; b < widths.size(); ++b) {
      if (widths[b] > bytes_.size()) bytes_.fail("a DAQmx buffer larger than the file");
      chunk += std::uint64_t{widths[b]} * counts[b];
    }
    if (chunk == 0) return;
    if ((end - bytes_.at()) % chunk != 0) file_.cut_off = true;
    while (end - bytes_.at() >= chunk) {
      const std::size_t begin = bytes_.at();
      for (Object* object : objects) {
        const Object::Scaler& scaler = object->scalers.front();
        object->scaler_id = scaler.id;
        std::size_t buffer = begin;
        for (std::uint32_t b = 0; b < scaler.buffer; ++b)
          buffer += static_cast<std::size_t>(std::uint64_t{widths[b]} * counts[b]);
        for (std::uint64_t k = 0; k < object->count && object->is_channel; ++k) {
          bytes_.go_to(buffer + static_cast<std::size_t>(k * widths[scaler.buffer]) + scaler.offset);
          file_.channels[object->channel].values.push_back(
              scaler_number(scaler.type, bytes_.number(size_of_scaler(scaler.type))));
        }
      }
      bytes_.go_to(begin + static_cast<std::size_t>(chunk));
    }
  }

  void read_contiguous(const std::vector<std::size_t>& objects) {
    for (const std::size_t index : objects) {
      Object& object = objects_[index];
      if (object.type == type_string || !object.is_channel) {
        bytes_.take(bytes_in_chunk(object));
        mark_unreadable(object, "text");
        continue;
      }
      for (std::uint64_t k = 0; k < object.count; ++k) read_sample(object);
    }
  }

  void read_interleaved(const std::vector<std::size_t>& objects) {
    const std::uint64_t rows = objects_[objects.front()].count;
    for (const std::size_t index : objects) {
      if (objects_[index].count != rows || objects_[index].type == type_string)
        bytes_.fail("interleaved channels of unlike length");
    }
    for (std::uint64_t k = 0; k < rows; ++k) {
      for (const std::size_t index : objects) read_sample(objects_[index]);
    }
  }

  void read_sample(Object& object) {
    const std::size_t size = size_of(object.type);
    if (!object.is_channel) {
      bytes_.take(size);
      return;
    }
    TdmsChannel& channel = file_.channels[object.channel];
    if (object.type == type_time_stamp) {
      const auto [seconds, fraction] = read_time_stamp();
      if (channel.values.empty()) channel.first_second = seconds;
      channel.is_time_stamp = true;
      // By unsigned numbers: a damaged stamp may be anywhere.
      const auto since = static_cast<std::int64_t>(static_cast<std::uint64_t>(seconds) -
                                                   static_cast<std::uint64_t>(channel.first_second));
      channel.values.push_back(static_cast<double>(since) + fraction);
      return;
    }
    if (size == 16 || object.type == type_complex_single) {
      bytes_.take(size);
      mark_unreadable(object, "complex numbers");
      return;
    }
    channel.values.push_back(as_number(object.type, bytes_.number(size)));
  }

  void mark_unreadable(const Object& object, std::string_view why) {
    if (object.is_channel && file_.channels[object.channel].unreadable.empty()) {
      file_.channels[object.channel].unreadable = why;
    }
  }

  static std::optional<double> number_in(const TdmsProperties& properties, const std::string& name) {
    const auto found = properties.find(name);
    return found != properties.end() && found->second.is_number ? std::optional(found->second.number) : std::nullopt;
  }
  static std::string text_in(const TdmsProperties& properties, const std::string& name) {
    const auto found = properties.find(name);
    return found == properties.end() ? "" : found->second.text;
  }

  static constexpr std::uint32_t source_is_raw = 0xffffffff;

  // The scales of a channel, from its own properties, its group's or the file's.
  class Scales {
   public:
    Scales(const TdmsProperties& properties, int count, std::uint32_t scaler, bool daqmx)
        : properties_(properties), count_(count), scaler_(scaler), daqmx_(daqmx) {}

    // Empty: done. Otherwise why the values cannot be scaled.
    std::string apply(std::vector<double>& values) {
      // The scaler of DAQmx data stands among the scales without a type of its own; it is the raw counts.
      int last = count_ - 1;
      while (last >= 0 && is_raw(last)) --last;
      if (last < 0) return "";
      raw_ = values;
      return compute(last, values, 0);
    }

   private:
    [[nodiscard]] std::string prefix(int scale) const { return "NI_Scale[" + std::to_string(scale) + "]_"; }
    [[nodiscard]] bool is_raw(int scale) const {
      if (daqmx_ && static_cast<std::uint32_t>(scale) == scaler_) return true;
      return text_in(properties_, prefix(scale) + "Scale_Type").empty();
    }

    std::string compute_source(double source, std::vector<double>& values, int depth) const {
      if (source >= static_cast<double>(source_is_raw)) {
        values = raw_;
        return "";
      }
      if (!(source >= 0.0) || source >= static_cast<double>(count_)) return "a scale of a scale that it has not";
      return compute(static_cast<int>(source), values, depth);
    }

    std::string compute(int scale, std::vector<double>& values, int depth) const {
      if (depth > count_) return "scales in a circle";
      if (is_raw(scale)) {
        values = raw_;
        return "";
      }
      const std::string kind = text_in(properties_, prefix(scale) + "Scale_Type");
      const std::string own = prefix(scale) + kind + "_";
      const auto number = [&](const std::string& name, double otherwise) {
        return number_in(properties_, own + name).value_or(otherwise);
      };
      if (kind == "Add" || kind == "Subtract") {
        std::vector<double> right;
        std::string why = compute_source(number("Left_Operand_Input_Source", source_is_raw), values, depth + 1);
        if (why.empty()) why = compute_source(number("Right_Operand_Input_Source", source_is_raw), right, depth + 1);
        for (std::size_t k = 0; why.empty() && k < values.size(); ++k)
          values[k] = kind == "Add" ? values[k] + right[k] : right[k] - values[k];  // as the driver subtracts
        return why;
      }
      if (kind != "Linear" && kind != "Polynomial" && kind != "Table") return "a scale of type " + kind;
      if (std::string why = compute_source(number("Input_Source", source_is_raw), values, depth + 1); !why.empty())
        return why;
      if (kind == "Table") return by_table(own, values);
      std::vector<double> coefficients{number("Y_Intercept", 0.0), number("Slope", 1.0)};
      if (kind == "Polynomial") {
        const double size = number("Coefficients_Size", 4.0);
        coefficients.clear();
        for (int k = 0; k < std::clamp(static_cast<int>(std::isfinite(size) ? size : 0.0), 0, 16); ++k)
          coefficients.push_back(number("Coefficients[" + std::to_string(k) + "]", 0.0));
      }
      for (double& value : values) {
        double scaled = 0.0;
        for (std::size_t k = coefficients.size(); k-- > 0;) scaled = scaled * value + coefficients[k];
        value = scaled;
      }
      return "";
    }

    std::string by_table(const std::string& own, std::vector<double>& values) const {
      const double size = number_in(properties_, own + "Scaled_Values_Size").value_or(0.0);
      std::vector<std::pair<double, double>> points;
      for (int k = 0; k < static_cast<int>(std::clamp(std::isfinite(size) ? size : 0.0, 0.0, 4096.0)); ++k) {
        const std::string index = "[" + std::to_string(k) + "]";
        points.emplace_back(number_in(properties_, own + "Pre_Scaled_Values" + index).value_or(0.0),
                            number_in(properties_, own + "Scaled_Values" + index).value_or(0.0));
      }
      if (points.size() < 2) return "a table of fewer than two points";
      std::sort(points.begin(), points.end());
      for (double& value : values) {
        const auto after = std::upper_bound(points.begin() + 1, points.end() - 1,
                                            std::pair(value, std::numeric_limits<double>::infinity()));
        const auto before = after - 1;
        const double step = after->first - before->first;
        const double share = step > 0.0 ? std::clamp((value - before->first) / step, 0.0, 1.0) : 0.0;
        value = before->second + share * (after->second - before->second);
      }
      return "";
    }

    const TdmsProperties& properties_;
    int count_;
    std::uint32_t scaler_;
    bool daqmx_;
    std::vector<double> raw_;
  };

  void finish(const Object& object) {
    if (!object.is_channel) return;
    TdmsChannel& channel = file_.channels[object.channel];
    if (text_in(channel.properties, "NI_Scaling_Status") == "scaled") return;
    const auto group = file_.groups.find(channel.group);
    const TdmsProperties none;
    const TdmsProperties& of_group = group == file_.groups.end() ? none : group->second;
    for (const TdmsProperties* properties :
         std::array<const TdmsProperties*, 3>{&channel.properties, &of_group, &file_.properties}) {
      const double scales = number_in(*properties, "NI_Number_Of_Scales").value_or(0.0);
      if (!(scales >= 1.0) || scales > 16.0) continue;
      if (text_in(*properties, "NI_Scaling_Status") == "scaled") return;
      const std::string why =
          Scales(*properties, static_cast<int>(scales), object.scaler_id, object.daqmx).apply(channel.values);
      if (!why.empty()) channel.unreadable = why;
      return;
    }
  }

  Bytes bytes_;
  TdmsFile file_;
  std::vector<Object> objects_;
  std::map<std::string, std::size_t, std::less<>> by_path_;
  std::vector<std::size_t> active_;  // objects with raw data in the segment, in order
  bool segment_is_big_endian_ = false;
};

}  // namespace

TdmsFile parse_tdms(std::string_view bytes, std::string_view source) { return Parser(bytes, source).run(); }

}  // namespace host_sim
