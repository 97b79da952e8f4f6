#include "host_sim/recording_files/binary/matlab_leaves.hpp"

#include <matio.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>

#include "firmware/description/text/input_error.hpp"

namespace host_sim {
namespace {

constexpr std::string_view a_whole_matlab_file = "a whole MATLAB 5 or 7.3 file";
constexpr int deepest_level = 8;                          // of structures in structures: dSPACE has three
constexpr std::size_t most_elements_of_structure = 4096;  // of a structure array or cell: signals of a file

struct FreeMatVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
struct CloseMatFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};

// The number of elements (variables) of a MATLAB 5 file: header of 128 bytes, then elements of a tag (type, length) and
// their bytes, those of uncompressed ones padded to 8. An InputError when the last does not end where the file ends;
// none for a file that is HDF5.
std::optional<std::size_t> count_elements(const std::filesystem::path& path, std::string_view source) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 128> header{};
  file.read(header.data(), header.size());
  const bool big_endian = header[126] == 'M';
  const char version = big_endian ? header[124] : header[125];
  if (!file || version != 1) return std::nullopt;

  const std::uint64_t size = std::filesystem::file_size(path);
  std::size_t elements = 0;
  for (std::uint64_t at = header.size(); at != size; ++elements) {
    std::array<unsigned char, 8> tag{};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(reinterpret_cast<char*>(tag.data()), tag.size());
    const auto number = [&](std::size_t first) {
      std::uint32_t n = 0;
      for (std::size_t i = 0; i < 4; ++i) n = n << 8U | tag[big_endian ? first + i : first + 3 - i];
      return n;
    };
    const std::uint32_t type = number(0);
    const std::uint64_t end = at + 8 + number(4);
    if (!file || end > size) {
      throw firmware::InputError(source, 0, "the file breaks off in variable " + std::to_string(elements + 1),
                                 a_whole_matlab_file);
    }
    if (type != MAT_T_MATRIX && type != MAT_T_COMPRESSED) {
      throw firmware::InputError(source, 0, "the file is damaged at variable " + std::to_string(elements + 1),
                                 a_whole_matlab_file);
    }
    at = end;
  }
  return elements;
}

template <class Number>
std::vector<double> as_doubles(const matvar_t& variable, std::size_t count) {
  const auto* numbers = static_cast<const Number*>(variable.data);
  std::vector<double> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<double>(numbers[i]);
  return result;
}

std::optional<std::vector<double>> numbers_of(const matvar_t& variable, std::size_t count) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return as_doubles<double>(variable, count);
    case MAT_C_SINGLE:
      return as_doubles<float>(variable, count);
    case MAT_C_INT8:
      return as_doubles<std::int8_t>(variable, count);
    case MAT_C_UINT8:
      return as_doubles<std::uint8_t>(variable, count);
    case MAT_C_INT16:
      return as_doubles<std::int16_t>(variable, count);
    case MAT_C_UINT16:
      return as_doubles<std::uint16_t>(variable, count);
    case MAT_C_INT32:
      return as_doubles<std::int32_t>(variable, count);
    case MAT_C_UINT32:
      return as_doubles<std::uint32_t>(variable, count);
    case MAT_C_INT64:
      return as_doubles<std::int64_t>(variable, count);
    case MAT_C_UINT64:
      return as_doubles<std::uint64_t>(variable, count);
    default:
      return std::nullopt;
  }
}

// The first row of a character array as UTF-8; matio keeps one, two or four bytes for a character.
std::string text_of(const matvar_t& variable, std::size_t count) {
  std::string text;
  const std::size_t rows = variable.rank > 0 ? std::max<std::size_t>(variable.dims[0], 1) : 1;
  const auto width = static_cast<std::size_t>(variable.data_size);
  for (std::size_t i = 0; i < count; i += rows) {
    std::uint32_t code = 0;
    const auto* bytes = static_cast<const unsigned char*>(variable.data) + i * width;
    for (std::size_t k = 0; k < width; ++k) code |= static_cast<std::uint32_t>(bytes[k]) << (8 * k);
    const bool is_utf8 = width == 1 && variable.data_type == MAT_T_UTF8;
    if (is_utf8 || code < 0x80) {
      text += static_cast<char>(code);
    } else if (code < 0x800) {
      text += static_cast<char>(0xc0U | code >> 6U);
      text += static_cast<char>(0x80U | (code & 0x3fU));
    } else {
      text += static_cast<char>(0xe0U | (code >> 12U & 0xfU));
      text += static_cast<char>(0x80U | (code >> 6U & 0x3fU));
      text += static_cast<char>(0x80U | (code & 0x3fU));
    }
  }
  return text;
}

class VariableSender {
 public:
  explicit VariableSender(const LeafSender& sender) : sender_(sender) {}

  void send(const std::string& path, matvar_t& variable, int level) const {
    std::optional<std::size_t> count = count_of(variable);
    if (variable.class_type == MAT_C_STRUCT && level < deepest_level)
      return send_structure(path, variable, count, level);
    if (variable.class_type == MAT_C_CELL && level < deepest_level) return send_cell(path, variable, count, level);
    Leaf leaf{path};
    for (int i = 0; i < variable.rank && i < 64; ++i) leaf.shape.push_back(variable.dims[i]);
    if (!count) {
      leaf.kind = LeafKind::damaged;
      return sender_.send(leaf);
    }
    if (variable.isComplex != 0) {
      leaf.kind = LeafKind::complex;
      return sender_.send(leaf);
    }
    const bool numeric = variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64;
    const bool characters = variable.class_type == MAT_C_CHAR;
    if (!numeric && !characters) return sender_.send(leaf);
    leaf.kind = numeric ? LeafKind::numbers : LeafKind::text;
    if (*count == 0) return sender_.send(leaf);
    if (variable.data == nullptr || variable.data_size <= 0 ||
        *count * static_cast<std::size_t>(variable.data_size) > variable.nbytes) {
      leaf.kind = numeric ? LeafKind::damaged : LeafKind::other;
      return sender_.send(leaf);
    }
    if (numeric) leaf.numbers = numbers_of(variable, *count).value_or(std::vector<double>{});
    if (characters) leaf.text = text_of(variable, *count);
    sender_.send(leaf);
  }

 private:
  // Product of the dimensions; none when it is more than the data can hold.
  static std::optional<std::size_t> count_of(const matvar_t& variable) {
    std::size_t count = 1;
    for (int i = 0; i < variable.rank; ++i) {
      const std::size_t length = variable.dims[i];
      if (length != 0 && count > variable.nbytes / length) return std::nullopt;
      count *= length;
    }
    return count;
  }

  void send_structure(const std::string& path, matvar_t& variable, std::optional<std::size_t> count, int level) const {
    char* const* fields = Mat_VarGetStructFieldnames(&variable);
    const unsigned number = Mat_VarGetNumberOfFields(&variable);
    if (!count) {
      // matio counts the bytes of a structure by its pointers; an empty one has none.
      std::size_t elements = 1;
      for (int i = 0; i < variable.rank; ++i) elements *= variable.dims[i];
      if (elements > 1) return sender_.send({path, LeafKind::other});
      count = elements;
    }
    const std::size_t elements = number == 0 ? 0 : std::min(*count, most_elements_of_structure);
    for (std::size_t e = 0; e < elements; ++e) {
      for (unsigned i = 0; fields != nullptr && i < number; ++i) {
        matvar_t* field = Mat_VarGetStructFieldByIndex(&variable, i, e);
        if (field == nullptr || fields[i] == nullptr) continue;
        const std::string index = *count == 1 ? "" : "(" + std::to_string(e + 1) + ")";
        send(path + index + "." + fields[i], *field, level + 1);
      }
    }
  }

  void send_cell(const std::string& path, matvar_t& variable, std::optional<std::size_t> count, int level) const {
    if (!count) return sender_.send({path, LeafKind::other});
    for (std::size_t e = 0; e < std::min(*count, most_elements_of_structure); ++e) {
      matvar_t* cell = Mat_VarGetCell(&variable, static_cast<int>(e));
      if (cell != nullptr) send(path + "{" + std::to_string(e + 1) + "}", *cell, level + 1);
    }
  }

  const LeafSender& sender_;
};

void send_all_variables(const LeafSender& sender, const char* path) {
  const std::unique_ptr<mat_t, CloseMatFile> file(Mat_Open(path, MAT_ACC_RDONLY));
  if (!file) return sender.send({"", LeafKind::damaged});
  const VariableSender variables(sender);
  std::size_t count = 0;
  while (const std::unique_ptr<matvar_t, FreeMatVariable> variable{Mat_VarReadNext(file.get())}) {
    ++count;
    variables.send(variable->name == nullptr ? "" : variable->name, *variable, 0);
  }
  sender.finish(count);
}

}  // namespace

std::vector<Leaf> read_matlab_leaves(const std::filesystem::path& file) {
  const std::string source = file.string();
  const std::optional<std::size_t> elements = count_elements(file, source);
  IsolatedResult result = read_isolated(source, a_whole_matlab_file,
                                        [&](const LeafSender& sender) { send_all_variables(sender, source.c_str()); });
  if (elements && result.count != *elements) {
    throw firmware::InputError(source, 0, "the file is damaged after variable " + std::to_string(result.count),
                               a_whole_matlab_file);
  }
  return std::move(result.leaves);
}

}  // namespace host_sim
