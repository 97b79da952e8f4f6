#include "host_sim/recording_files/binary/mdf_file.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/units.hpp"
#include "firmware/recording/column_targets.hpp"
#include "host_sim/recording_files/tables/headings.hpp"

namespace host_sim {
namespace {

constexpr std::size_t mdf_head_size = 24;                         // of every block: id, length, number of links
constexpr std::size_t most_mdf_blocks = 1000000;                  // of a list: a circle ends there
constexpr std::uint64_t most_mdf_data = std::uint64_t{4} << 30U;  // [byte] of a group, decompressed
constexpr std::uint64_t best_packing = 1100;                      // deflate packs at most 1032 : 1
constexpr std::uint64_t most_virtual_rows = 1000000;              // of a group without data: nothing else bounds them

// A block: its links and the bytes behind them.
struct MdfBlock {
  std::string id;
  std::vector<std::uint64_t> links;
  std::string_view data;

  [[nodiscard]] std::uint64_t link(std::size_t k) const { return k < links.size() ? links[k] : 0; }
};

std::uint64_t mdf_number(std::string_view bytes, std::size_t at, std::size_t size, bool big_endian = false) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t k = at + (big_endian ? i : size - 1 - i);
    value = value << 8U | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0U);
  }
  return value;
}

double mdf_double(std::string_view bytes, std::size_t at) { return std::bit_cast<double>(mdf_number(bytes, at, 8)); }

// How raw values become physical ones.
struct MdfConversion {
  unsigned type = 0;
  std::vector<double> values;
  std::string unit;
  std::string unreadable;  // why not; empty: it is

  [[nodiscard]] double apply(double x) const {
    switch (type) {
      case 1:
        return values[0] + values[1] * x;
      case 2:
        return (values[0] * x * x + values[1] * x + values[2]) / (values[3] * x * x + values[4] * x + values[5]);
      case 4:
      case 5:
        return by_table(x);
      case 6:
        return by_range(x);
      default:
        return x;
    }
  }

 private:
  // Pairs of key and value in rising order; between keys linear, or the value of the nearest key.
  [[nodiscard]] double by_table(double x) const {
    const std::size_t count = values.size() / 2;
    if (std::isnan(x)) return x;
    if (x <= values[0]) return values[1];
    for (std::size_t k = 1; k < count; ++k) {
      const double from = values[2 * k - 2];
      const double to = values[2 * k];
      if (x > to) continue;
      const double share = to > from ? (x - from) / (to - from) : 0.0;
      if (type == 5) return share > 0.5 ? values[2 * k + 1] : values[2 * k - 1];
      return values[2 * k - 1] + share * (values[2 * k + 1] - values[2 * k - 1]);
    }
    return values[2 * count - 1];
  }
  [[nodiscard]] double by_range(double x) const {
    const std::size_t count = values.size() / 3;
    for (std::size_t k = 0; k < count; ++k) {
      if (x >= values[3 * k] && x <= values[3 * k + 1]) return values[3 * k + 2];
    }
    return values.back();  // the default
  }
};

struct MdfChannel {
  std::string name, unit;
  unsigned type = 0, sync = 0, data_type = 0, bit_offset = 0;
  std::uint32_t byte_offset = 0, bit_count = 0, flags = 0, invalid_bit = 0;
  MdfConversion conversion;
  std::string unreadable;

  [[nodiscard]] bool is_master() const { return (type == 2 || type == 3) && (sync == 1 || sync == 0); }
  [[nodiscard]] bool is_virtual() const { return type == 3 || type == 6; }
};

struct MdfGroup {
  std::string name;
  std::uint64_t record_id = 0, cycles = 0;
  std::uint64_t at = 0;             // its block
  std::uint64_t remote_master = 0;  // block of the group that holds its time; 0: it has its own
  std::size_t data_bytes = 0, invalid_bytes = 0;
  bool variable_length = false;
  std::vector<MdfChannel> channels;
  std::string records;  // sorted: one after the other
  std::string invalid;  // of columns (DI), one after the other; empty: behind each record
};

class MdfReader {
 public:
  MdfReader(std::string_view bytes, std::string_view source) : bytes_(bytes), source_(source) {}

  RawTable run() {
    if (bytes_.size() < 64) fail("the file ends within its head");
    const unsigned version = static_cast<unsigned>(mdf_number(bytes_, 28, 2));
    if (version < 400 || bytes_.substr(8, 1) < "4") {
      throw firmware::InputError(source_, 0,
                                 "this is an MDF " + std::string(firmware::trimmed(bytes_.substr(8, 4))) + " file",
                                 "MDF 4: the program that wrote it, or asammdf, converts it");
    }
    if (bytes_.starts_with("UnFin")) {
      throw firmware::InputError(source_, 0, "this is an MDF file that its program did not finish",
                                 "the finalized file: the program, or asammdf, finalizes it");
    }
    const MdfBlock head = block(64, "##HD");
    table_.source = source_;
    table_.format = "MDF " + std::to_string(version / 100) + "." + std::to_string(version % 100 / 10) +
                    std::to_string(version % 10);
    std::size_t count = 0;
    for (std::uint64_t at = head.link(0); at != 0; ++count) {
      if (count > most_mdf_blocks) fail("its groups form a circle");
      const MdfBlock data_group = block(at, "##DG");
      read_data_group(data_group);
      at = data_group.link(0);
    }
    for (const MdfGroup& group : waiting_) take_group(group);
    return make_table();
  }

 private:
  [[noreturn]] void fail(const std::string& wrong) const {
    throw firmware::InputError(source_, 0, "the MDF file is damaged: " + wrong, "a whole MDF 4 file");
  }

  [[nodiscard]] MdfBlock block(std::uint64_t at, std::string_view id = "") const {
    if (at > bytes_.size() || bytes_.size() - at < mdf_head_size) fail("a block lies behind the end");
    MdfBlock result;
    const auto begin = static_cast<std::size_t>(at);
    result.id = bytes_.substr(begin, 4);
    if (!id.empty() && result.id != id) fail("a block " + std::string(id) + " is missing");
    const std::uint64_t length = mdf_number(bytes_, begin + 8, 8);
    const std::uint64_t links = mdf_number(bytes_, begin + 16, 8);
    if (length < mdf_head_size || length > bytes_.size() - at || links > (length - mdf_head_size) / 8)
      fail("a block " + printable(result.id) + " is longer than the file");
    for (std::uint64_t k = 0; k < links; ++k)
      result.links.push_back(mdf_number(bytes_, begin + mdf_head_size + static_cast<std::size_t>(8 * k), 8));
    const auto data = begin + mdf_head_size + static_cast<std::size_t>(8 * links);
    result.data = bytes_.substr(data, begin + static_cast<std::size_t>(length) - data);
    return result;
  }

  static std::string printable(std::string text) {
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = '?';
    }
    return text;
  }

  // A text block; of a block with XML the text in <TX>.
  [[nodiscard]] std::string text(std::uint64_t at) const {
    if (at == 0) return "";
    const MdfBlock one = block(at);
    std::string_view content = one.data.substr(0, one.data.find('\0'));
    if (one.id == "##MD") {
      const std::size_t begin = content.find("<TX>");
      const std::size_t end = content.find("</TX>");
      if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) return "";
      content = content.substr(begin + 4, end - begin - 4);
    }
    return std::string(firmware::trimmed(content));
  }

  // --- Descriptions ------------------------------------------------------------------------------------------------

  void read_data_group(const MdfBlock& data_group) {
    const auto id_size = static_cast<std::size_t>(mdf_number(data_group.data, 0, 1));
    std::vector<MdfGroup> groups;
    std::size_t count = 0;
    for (std::uint64_t at = data_group.link(1); at != 0; ++count) {
      if (count > most_mdf_blocks) fail("its groups form a circle");
      const MdfBlock channel_group = block(at, "##CG");
      MdfGroup group;
      group.name = text(channel_group.link(2));
      group.record_id = mdf_number(channel_group.data, 0, 8);
      group.cycles = mdf_number(channel_group.data, 8, 8);
      const auto flags = static_cast<unsigned>(mdf_number(channel_group.data, 16, 2));
      group.variable_length = (flags & 1U) != 0;
      group.at = at;
      if ((flags & 8U) != 0 && channel_group.links.size() > 6) group.remote_master = channel_group.link(6);
      group.data_bytes = static_cast<std::size_t>(mdf_number(channel_group.data, 24, 4));
      group.invalid_bytes = static_cast<std::size_t>(mdf_number(channel_group.data, 28, 4));
      if (!group.variable_length) read_channels(channel_group.link(1), group, 0);
      at = channel_group.link(0);
      groups.push_back(std::move(group));
    }
    std::string invalid;
    std::string data = data_of(data_group.link(2), invalid);
    if (groups.empty()) return;
    if (id_size == 0) {
      groups.front().records = std::move(data);
      groups.front().invalid = std::move(invalid);
    } else {
      sort_records(groups, data, id_size);
    }
    for (MdfGroup& group : groups) {
      ++group_number_;
      if (group.variable_length) continue;
      group.name = group.name.empty() ? "group " + std::to_string(group_number_) : group.name;
      // Columns in groups of their own (4.2) have their time in another group, which may stand behind them.
      if (group.remote_master != 0) {
        waiting_.push_back(std::move(group));
      } else {
        take_group(group);
      }
    }
  }

  void read_channels(std::uint64_t at, MdfGroup& group, int level) {
    while (at != 0) {
      if (++channels_read_ > most_mdf_blocks || level > 8) fail("its channels form a circle");
      const MdfBlock one = block(at, "##CN");
      MdfChannel channel;
      channel.name = text(one.link(2));
      channel.unit = text(one.link(6));
      channel.type = static_cast<unsigned>(mdf_number(one.data, 0, 1));
      channel.sync = static_cast<unsigned>(mdf_number(one.data, 1, 1));
      channel.data_type = static_cast<unsigned>(mdf_number(one.data, 2, 1));
      channel.bit_offset = static_cast<unsigned>(mdf_number(one.data, 3, 1));
      channel.byte_offset = static_cast<std::uint32_t>(mdf_number(one.data, 4, 4));
      channel.bit_count = static_cast<std::uint32_t>(mdf_number(one.data, 8, 4));
      channel.flags = static_cast<std::uint32_t>(mdf_number(one.data, 12, 4));
      channel.invalid_bit = static_cast<std::uint32_t>(mdf_number(one.data, 16, 4));
      channel.conversion = conversion(one.link(4));
      if (channel.unit.empty()) channel.unit = channel.conversion.unit;
      channel.unreadable = why_unreadable(channel, group);
      const std::uint64_t composition = one.link(1);
      if (composition != 0) {
        if (block(composition).id == "##CN") {
          read_channels(composition, group, level + 1);  // the members of a structure
          at = one.link(0);
          continue;
        }
        channel.unreadable = "an array";
      }
      group.channels.push_back(std::move(channel));
      at = one.link(0);
    }
  }

  static std::string why_unreadable(const MdfChannel& channel, const MdfGroup& group) {
    if (channel.type == 1 || channel.type == 5) return "values of variable length";
    if (channel.type == 4) return "positions in another file";
    if (!channel.conversion.unreadable.empty()) return channel.conversion.unreadable;
    if (channel.is_virtual()) return "";
    if (channel.data_type >= 6)
      return channel.data_type <= 9 ? "text" : channel.data_type >= 15 ? "complex numbers" : "bytes";
    const bool floating = channel.data_type == 4 || channel.data_type == 5;
    if (floating && channel.bit_count != 32 && channel.bit_count != 64)
      return channel.bit_count == 16 ? "16-bit floating point numbers" : "numbers of an unknown kind";
    if (channel.bit_count == 0 || channel.bit_count > 64 || channel.bit_offset > 7) return "numbers of an unknown size";
    const std::uint64_t bytes = (std::uint64_t{channel.bit_offset} + channel.bit_count + 7) / 8;
    if (bytes > 8 || channel.byte_offset + bytes > group.data_bytes) return "numbers outside their records";
    return "";
  }

  [[nodiscard]] MdfConversion conversion(std::uint64_t at) const {
    MdfConversion result;
    if (at == 0) return result;
    const MdfBlock one = block(at, "##CC");
    result.unit = text(one.link(1));
    result.type = static_cast<unsigned>(mdf_number(one.data, 0, 1));
    const auto count = static_cast<std::size_t>(mdf_number(one.data, 6, 2));
    constexpr std::size_t values_at = 24;  // behind the limits
    if (one.data.size() < values_at || count > (one.data.size() - values_at) / 8) fail("a conversion ends early");
    for (std::size_t k = 0; k < count; ++k) result.values.push_back(mdf_double(one.data, values_at + 8 * k));
    const std::array<std::size_t, 7> least{0, 2, 6, 0, 4, 4, 4};
    if (result.type == 3) result.unreadable = "a conversion by a formula";
    // Texts beside numbers: the numbers are what was measured.
    if (result.type >= 7) result.type = result.type <= 8 ? 0 : result.type;
    if (result.type > 8) result.unreadable = "a conversion of texts";
    if (result.type < least.size() && result.values.size() < least[result.type])
      fail("a conversion has too few numbers");
    return result;
  }

  // --- Data --------------------------------------------------------------------------------------------------------

  // The data of a group in one piece; invalidation bits of columns beside it.
  std::string data_of(std::uint64_t at, std::string& invalid) const {
    std::string data;
    std::size_t count = 0;
    append(at, data, invalid, count);
    return data;
  }

  void append(std::uint64_t at, std::string& data, std::string& invalid, std::size_t& count,
              bool in_list = false) const {
    while (at != 0) {
      if (++count > most_mdf_blocks || data.size() > most_data()) fail("its data form a circle");
      const MdfBlock one = block(at);
      if (one.id == "##DT" || one.id == "##DV" || one.id == "##RD" || one.id == "##SD") {
        data += one.data;
        return;
      }
      if (one.id == "##DI") {
        invalid += one.data;
        return;
      }
      if (one.id == "##DZ") {
        inflate_block(one, one.data.substr(0, 2) == "DI" ? invalid : data);
        return;
      }
      if (in_list) fail("a list within a list");
      if (one.id == "##HL") {
        at = one.link(0);
        continue;
      }
      if (one.id != "##DL" && one.id != "##LD") fail("data in a block " + printable(one.id));
      const bool columns = one.id == "##LD";
      const bool with_invalid = columns && (mdf_number(one.data, 0, 4) & 0x80000000U) != 0;
      // LD: the data blocks, then as many with invalidation bits.
      const std::size_t blocks = with_invalid ? (one.links.size() - 1) / 2 : one.links.size() - 1;
      if (one.links.empty()) fail("a list without links");
      for (std::size_t k = 0; k < one.links.size() - 1; ++k) {
        if (one.links[k + 1] == 0) continue;
        if (k < blocks) {
          append(one.links[k + 1], data, invalid, count, true);
        } else {
          append(one.links[k + 1], invalid, invalid, count, true);
        }
      }
      at = one.link(0);
    }
  }

  void inflate_block(const MdfBlock& one, std::string& into) const {
    const auto kind = static_cast<unsigned>(mdf_number(one.data, 2, 1));
    const auto columns = static_cast<std::size_t>(mdf_number(one.data, 4, 4));
    const std::uint64_t size = mdf_number(one.data, 8, 8);
    const std::uint64_t packed = mdf_number(one.data, 16, 8);
    constexpr std::size_t packed_at = 24;
    if (one.data.size() < packed_at || packed > one.data.size() - packed_at || kind > 1)
      fail("a compressed block ends early");
    if (size > best_packing * (packed + 64) || into.size() + size > most_data())
      fail("a compressed block of impossible size");
    std::string bytes(static_cast<std::size_t>(size), '\0');
    auto length = static_cast<uLongf>(size);
    if (size > 0 &&
        (uncompress(reinterpret_cast<Bytef*>(bytes.data()), &length,
                    reinterpret_cast<const Bytef*>(one.data.data() + packed_at), static_cast<uLong>(packed)) != Z_OK ||
         length != size))
      fail("a compressed block cannot be unpacked");
    if (kind == 1 && columns > 0) {
      // Transposed: all first bytes of the records, all second bytes …; what is no whole record stands behind.
      const std::size_t rows = bytes.size() / columns;
      const std::size_t before = into.size();
      into.resize(before + bytes.size());
      for (std::size_t c = 0; c < columns; ++c) {
        for (std::size_t r = 0; r < rows; ++r) into[before + r * columns + c] = bytes[c * rows + r];
      }
      std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(rows * columns), bytes.end(),
                into.begin() + static_cast<std::ptrdiff_t>(before + rows * columns));
      return;
    }
    into += bytes;
  }

  // Records of several groups, each behind its number.
  void sort_records(std::vector<MdfGroup>& groups, const std::string& data, std::size_t id_size) const {
    if (id_size > 8) fail("record numbers of " + std::to_string(id_size) + " bytes");
    std::map<std::uint64_t, MdfGroup*> by_id;
    for (MdfGroup& group : groups) by_id[group.record_id] = &group;
    const std::string_view view(data);
    for (std::size_t at = 0; at + id_size <= view.size();) {
      const auto found = by_id.find(mdf_number(view, at, id_size));
      if (found == by_id.end()) fail("a record of an unknown group");
      at += id_size;
      MdfGroup& group = *found->second;
      std::size_t size = group.data_bytes + group.invalid_bytes;
      if (group.variable_length) size = 4 + static_cast<std::size_t>(mdf_number(view, at, 4));
      if (size > view.size() - at) return;  // cut off
      if (!group.variable_length) group.records.append(view.substr(at, size));
      at += size;
    }
  }

  // --- Values ------------------------------------------------------------------------------------------------------

  [[nodiscard]] static double raw_value(const MdfChannel& channel, std::string_view record) {
    const bool big_endian = channel.data_type == 1 || channel.data_type == 3 || channel.data_type == 5;
    const std::size_t size = (channel.bit_offset + channel.bit_count + 7) / 8;
    std::uint64_t raw = mdf_number(record, channel.byte_offset, size, big_endian) >> channel.bit_offset;
    if (channel.data_type == 4 || channel.data_type == 5) {
      return channel.bit_count == 32 ? static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)))
                                     : std::bit_cast<double>(raw);
    }
    if (channel.bit_count < 64) raw &= (std::uint64_t{1} << channel.bit_count) - 1;
    const bool is_signed = channel.data_type == 2 || channel.data_type == 3;
    if (!is_signed) return static_cast<double>(raw);
    if (channel.bit_count < 64 && (raw >> (channel.bit_count - 1) & 1U) != 0)
      raw |= ~std::uint64_t{0} << channel.bit_count;
    return static_cast<double>(static_cast<std::int64_t>(raw));
  }

  [[nodiscard]] std::vector<double> values_of(const MdfChannel& channel, const MdfGroup& group,
                                              std::size_t rows) const {
    std::vector<double> values(rows);
    const bool beside = !group.invalid.empty();
    const std::size_t record = group.data_bytes + (beside ? 0 : group.invalid_bytes);
    const std::string_view records(group.records);
    for (std::size_t k = 0; k < rows; ++k) {
      const bool all_invalid = (channel.flags & 1U) != 0;
      bool invalid = all_invalid;
      if ((channel.flags & 2U) != 0 && channel.invalid_bit / 8 < group.invalid_bytes) {
        const std::size_t at = beside ? k * group.invalid_bytes : k * record + group.data_bytes;
        invalid = invalid ||
                  (mdf_number(beside ? std::string_view(group.invalid) : records, at + channel.invalid_bit / 8, 1) >>
                       (channel.invalid_bit % 8) &
                   1U) != 0;
      }
      const double raw =
          channel.is_virtual() ? static_cast<double>(k) : raw_value(channel, records.substr(k * record, record));
      values[k] = invalid ? std::numeric_limits<double>::quiet_NaN() : channel.conversion.apply(raw);
    }
    return values;
  }

  void take_group(const MdfGroup& group) {
    const std::string& name = group.name;
    const std::size_t record = group.data_bytes + (group.invalid.empty() ? group.invalid_bytes : 0);
    const std::uint64_t there = record == 0 ? most_virtual_rows : group.records.size() / record;
    const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>({group.cycles, there, most_mdf_data / 8}));
    if (rows < group.cycles)
      table_.left_out.push_back({name, std::to_string(group.cycles - rows) + " of " + std::to_string(group.cycles) +
                                           " rows: the data end early"});
    if (rows < 2) {
      for (const MdfChannel& channel : group.channels)
        table_.left_out.push_back({name + "/" + channel.name, rows == 0 ? "no values" : "one value"});
      return;
    }
    const auto master = std::find_if(group.channels.begin(), group.channels.end(), [](const MdfChannel& channel) {
      return channel.is_master() && channel.unreadable.empty();
    });
    std::vector<double> time;
    if (master != group.channels.end()) {
      time = values_of(*master, group, rows);
      const std::optional<firmware::Unit> unit = firmware::find_unit(master->unit);
      if (unit && unit->dimension == firmware::Dimension::time && unit->scale != 1.0) {
        for (double& t : time) t = firmware::Target::in_seconds(t, unit->scale);
      }
      times_[group.at] = {master->name, time};
    } else if (const auto remote = times_.find(group.remote_master); remote != times_.end()) {
      if (remote->second.second.size() == rows) time = remote->second.second;
    }
    for (const MdfChannel& channel : group.channels) {
      if (master != group.channels.end() && &channel == &*master) continue;
      if (!channel.unreadable.empty()) {
        table_.left_out.push_back({name + "/" + channel.name, channel.unreadable});
        continue;
      }
      if (time.empty()) {
        table_.left_out.push_back({name + "/" + channel.name, "its group has no time"});
        continue;
      }
      const NameAndUnit heading = split_heading(channel.name);
      RawColumn column{channel.unit.empty() ? heading.name : channel.name};
      column.text = channel.name;
      column.unit = channel.unit.empty() ? heading.unit : channel.unit;
      column.group = name;
      column.values = values_of(channel, group, rows);
      column.own_time = time;
      column.own_time_name = master != group.channels.end() ? master->name : times_[group.remote_master].first;
      table_.columns.push_back(std::move(column));
    }
  }

  RawTable make_table() {
    if (table_.columns.empty()) {
      throw firmware::InputError(source_, 0,
                                 "no channel of the MDF file has numbers and a time" +
                                     (table_.left_out.empty() ? std::string()
                                                              : ": " + firmware::in_quotes(table_.left_out[0].name) +
                                                                    " holds " + table_.left_out[0].reason),
                                 "a group with a master channel");
    }
    const bool one_axis = std::all_of(table_.columns.begin(), table_.columns.end(), [&](const RawColumn& column) {
      return column.own_time == table_.columns.front().own_time;
    });
    if (one_axis) {
      RawColumn time{"t"};
      time.text = "t";
      time.unit = "s";
      time.values = table_.columns.front().own_time;
      table_.rows = time.values.size();
      for (RawColumn& column : table_.columns) column.own_time.clear();
      table_.columns.insert(table_.columns.begin(), std::move(time));
    }
    return std::move(table_);
  }

  // [byte] A list may name a block twice; more data than the file can hold are a circle.
  [[nodiscard]] std::uint64_t most_data() const { return std::min(most_mdf_data, best_packing * (bytes_.size() + 64)); }

  std::string_view bytes_;
  std::string source_;
  RawTable table_;
  std::map<std::uint64_t, std::pair<std::string, std::vector<double>>>
      times_;  // by group: the master's name, its values
  std::vector<MdfGroup> waiting_;
  std::size_t group_number_ = 0;
  std::size_t channels_read_ = 0;
};

}  // namespace

bool is_mdf(std::string_view head) {
  return head.size() >= 64 && (head.starts_with("MDF     ") || head.starts_with("UnFinMF "));
}

RawTable table_of_mdf(std::string_view bytes, std::string_view source) { return MdfReader(bytes, source).run(); }

}  // namespace host_sim
