#include "host_sim/recording_files/binary/matlab_leaves.hpp"

#include <matio.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
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

// One element (variable) of a MATLAB 5 file.
struct MatElement {
  std::uint64_t begin = 0, end = 0;  // in the file, with the tag
  std::string name;
  unsigned array_class = 0;  // MATLAB's number of the class
  std::string of_class;      // of an object: "string"
};

std::uint32_t number_at(std::string_view bytes, std::size_t at, bool big_endian) {
  std::uint32_t n = 0;
  for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i)
    n = n << 8U | static_cast<unsigned char>(bytes[at + (big_endian ? i : 3 - i)]);
  return n;
}

// The text of a sub-element at `at`, which moves behind it: a tag of eight bytes, or of four with up to four bytes.
std::string sub_element(std::string_view bytes, std::size_t& at, bool big_endian) {
  if (at + 8 > bytes.size()) return "";
  const std::uint32_t tag = number_at(bytes, at, big_endian);
  if (const std::uint32_t small = tag >> 16U; small != 0) {
    std::string text(bytes.substr(at + 4, std::min<std::size_t>(small, 4)));
    at += 8;
    return text;
  }
  const std::uint32_t size = number_at(bytes, at + 4, big_endian);
  std::string text(bytes.substr(at + 8, std::min<std::size_t>(size, bytes.size() - at - 8)));
  at += 8 + (static_cast<std::size_t>(size) + 7) / 8 * 8;
  return text;
}

// The first bytes of an element's contents, decompressed where they are compressed.
std::string first_bytes(std::ifstream& file, const MatElement& element, bool compressed) {
  constexpr std::size_t enough = 1024;  // of flags, dimensions and names
  std::string raw(static_cast<std::size_t>(std::min<std::uint64_t>(element.end - element.begin - 8, 4 * enough)), '\0');
  file.seekg(static_cast<std::streamoff>(element.begin + 8));
  file.read(raw.data(), static_cast<std::streamsize>(raw.size()));
  file.clear();
  if (!compressed) return raw;
  std::string bytes(enough, '\0');
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return "";
  stream.next_in = reinterpret_cast<Bytef*>(raw.data());
  stream.avail_in = static_cast<uInt>(raw.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  inflate(&stream, Z_SYNC_FLUSH);
  bytes.resize(bytes.size() - stream.avail_out);
  inflateEnd(&stream);
  return bytes.size() < 8 ? "" : bytes.substr(8);  // behind the tag of the matrix
}

void read_name_and_class(MatElement& element, std::string_view bytes, bool big_endian) {
  constexpr unsigned opaque = 17;
  std::size_t at = 0;
  const std::string flags = sub_element(bytes, at, big_endian);
  if (flags.size() < 4) return;
  element.array_class = number_at(flags, 0, big_endian) & 0xffU;
  if (element.array_class != opaque) static_cast<void>(sub_element(bytes, at, big_endian));  // dimensions
  element.name = sub_element(bytes, at, big_endian);
  if (element.array_class != opaque) return;
  static_cast<void>(sub_element(bytes, at, big_endian));  // "MCOS"
  element.of_class = sub_element(bytes, at, big_endian);
}

// The elements of a MATLAB 5 file: header of 128 bytes, then elements of a tag (type, length) and their bytes, those of
// uncompressed ones padded to 8. An InputError when the last does not end where the file ends; none for a file that is
// HDF5.
// Source: MathWorks, "MAT-File Format", R2023b, level 5.
std::optional<std::vector<MatElement>> list_elements(const std::filesystem::path& path, std::string_view source) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 128> header{};
  file.read(header.data(), header.size());
  const bool big_endian = header[126] == 'M';
  const char version = big_endian ? header[124] : header[125];
  if (!file || version != 1) return std::nullopt;

  const std::uint64_t size = std::filesystem::file_size(path);
  std::vector<MatElement> elements;
  for (std::uint64_t at = header.size(); at != size;) {
    std::array<char, 8> tag{};
    file.seekg(static_cast<std::streamoff>(at));
    file.read(tag.data(), tag.size());
    const std::string_view bytes(tag.data(), tag.size());
    const std::uint32_t type = number_at(bytes, 0, big_endian);
    MatElement element;
    element.begin = at;
    element.end = at + 8 + number_at(bytes, 4, big_endian);
    if (!file || element.end > size) {
      throw firmware::InputError(source, 0, "the file breaks off in variable " + std::to_string(elements.size() + 1),
                                 a_whole_matlab_file);
    }
    if (type != MAT_T_MATRIX && type != MAT_T_COMPRESSED) {
      throw firmware::InputError(source, 0, "the file is damaged at variable " + std::to_string(elements.size() + 1),
                                 a_whole_matlab_file);
    }
    read_name_and_class(element, first_bytes(file, element, type == MAT_T_COMPRESSED), big_endian);
    at = element.end;
    elements.push_back(std::move(element));
  }
  return elements;
}

// Why a variable is none of numbers, texts, structures and cells; empty: it is one of these.
std::string why_left_out(const MatElement& element) {
  switch (element.array_class) {
    case 3:
      return "an object";
    case 5:
      return "a sparse matrix";
    case 16:
      return "a function handle";
    case 17:
      return element.of_class.empty() ? "an object" : "an object of class " + element.of_class;
    default:
      // What MATLAB keeps of the objects of a workspace: a variable without a name.
      return element.name.empty() && element.array_class == 9 ? "the contents of objects" : "";
  }
}

// A copy of the file without some of its elements, in memory; matio ends at what it does not know.
class MatFileCopy {
 public:
  MatFileCopy(const std::filesystem::path& path, const std::vector<MatElement>& elements, const std::string& source)
      : descriptor_(::memfd_create("rigtwin", MFD_CLOEXEC)) {
    std::ifstream file(path, std::ios::binary);
    copy(file, 0, 128, source);
    for (const MatElement& element : elements) {
      if (why_left_out(element).empty()) copy(file, element.begin, element.end, source);
    }
  }
  ~MatFileCopy() { ::close(descriptor_); }
  MatFileCopy(const MatFileCopy&) = delete;
  MatFileCopy& operator=(const MatFileCopy&) = delete;
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

 private:
  void copy(std::ifstream& file, std::uint64_t begin, std::uint64_t end, const std::string& source) const {
    std::string block(static_cast<std::size_t>(std::min<std::uint64_t>(end - begin, 1U << 20U)), '\0');
    file.seekg(static_cast<std::streamoff>(begin));
    while (begin < end) {
      const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(end - begin, block.size()));
      file.read(block.data(), static_cast<std::streamsize>(size));
      if (!file || ::write(descriptor_, block.data(), size) != static_cast<ssize_t>(size))
        throw firmware::InputError(source, 0, "cannot be copied without its objects", "room in memory");
      begin += size;
    }
  }

  int descriptor_;
};

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
  const std::optional<std::vector<MatElement>> elements = list_elements(file, source);
  std::vector<Leaf> left_out;
  std::size_t expected = 0;
  for (const MatElement& element : elements ? *elements : std::vector<MatElement>{}) {
    const std::string why = why_left_out(element);
    if (why.empty()) ++expected;
    if (!why.empty() && !element.name.empty()) left_out.push_back({element.name, LeafKind::other, {}, {}, why});
  }
  const bool some = elements && expected < elements->size();
  const std::optional<MatFileCopy> copy =
      some ? std::optional<MatFileCopy>(std::in_place, file, *elements, source) : std::nullopt;
  const std::string path = copy ? copy->path() : source;
  IsolatedResult result = read_isolated(source, a_whole_matlab_file,
                                        [&](const LeafSender& sender) { send_all_variables(sender, path.c_str()); });
  if (elements && result.count != expected) {
    throw firmware::InputError(source, 0, "the file is damaged after variable " + std::to_string(result.count),
                               a_whole_matlab_file);
  }
  result.leaves.insert(result.leaves.end(), left_out.begin(), left_out.end());
  return std::move(result.leaves);
}

std::vector<std::uint64_t> matlab_element_sizes(const std::filesystem::path& file) {
  std::vector<std::uint64_t> sizes;
  try {
    const std::optional<std::vector<MatElement>> elements = list_elements(file, file.string());
    for (const MatElement& element : elements ? *elements : std::vector<MatElement>{}) {
      sizes.push_back(element.end - element.begin);
    }
  } catch (const firmware::InputError&) {
    sizes.clear();
  }
  return sizes;
}

bool is_matlab_4(std::string_view head) {
  if (head.size() < 21) return false;
  for (const bool big_endian : {false, true}) {
    const std::uint32_t type = number_at(head, 0, big_endian);
    const std::uint32_t name_size = number_at(head, 16, big_endian);
    const bool kind =
        type / 1000 == (big_endian ? 1U : 0U) && type % 1000 / 100 == 0 && type % 100 / 10 <= 5 && type % 10 <= 2;
    if (!kind || number_at(head, 12, big_endian) > 1 || name_size < 2 || name_size > 64) continue;
    const std::string_view name = head.substr(20, name_size - 1);
    if (20 + name_size <= head.size() && head[20 + name_size - 1] == '\0' && number_at(head, 4, big_endian) > 0 &&
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; }))
      return true;
  }
  return false;
}

// Source: MathWorks, "MAT-File Format", R2023b, level 4.
std::vector<Leaf> read_matlab_4_leaves(std::string_view bytes, std::string_view source) {
  std::vector<Leaf> leaves;
  std::size_t at = 0;
  const auto fail = [&](const std::string& wrong) {
    throw firmware::InputError(source, 0, wrong + " in variable " + std::to_string(leaves.size() + 1),
                               "a whole MATLAB 4 file, or one saved with -v7");
  };
  while (at < bytes.size()) {
    if (bytes.size() - at < 20) fail("the file breaks off");
    const bool big_endian = number_at(bytes, at, false) > 9999;
    const std::uint32_t type = number_at(bytes, at, big_endian);
    const std::uint64_t rows = number_at(bytes, at + 4, big_endian);
    const std::uint64_t columns = number_at(bytes, at + 8, big_endian);
    const bool complex = number_at(bytes, at + 12, big_endian) != 0;
    const std::uint32_t name_size = number_at(bytes, at + 16, big_endian);
    constexpr std::array<std::uint64_t, 6> sizes{8, 4, 4, 2, 2, 1};
    const std::uint32_t precision = type % 100 / 10;
    if (type / 1000 > 1 || precision >= sizes.size() || name_size == 0 || name_size > 4096) fail("the file is damaged");
    at += 20;
    const std::uint64_t size = sizes[precision];
    const std::uint64_t room = bytes.size() - at;
    if (name_size > room || (rows != 0 && columns > room / rows) ||
        rows * columns * size * (complex ? 2 : 1) > room - name_size)
      fail("the file breaks off");
    std::string name(bytes.substr(at, name_size));
    name = name.substr(0, name.find('\0'));
    at += name_size;
    const auto count = static_cast<std::size_t>(rows * columns);
    Leaf leaf{name, LeafKind::numbers, {static_cast<std::size_t>(rows), static_cast<std::size_t>(columns)}};
    if (complex) leaf.kind = LeafKind::complex;
    if (type % 10 == 2) {
      leaf.kind = LeafKind::other;
      leaf.text = "a sparse matrix";
    }
    for (std::size_t k = 0; k < count && leaf.kind == LeafKind::numbers; ++k) {
      std::uint64_t raw = 0;
      for (std::size_t i = 0; i < size; ++i)
        raw = raw << 8U | static_cast<unsigned char>(bytes[at + k * size + (big_endian ? i : size - 1 - i)]);
      switch (precision) {
        case 0:
          leaf.numbers.push_back(std::bit_cast<double>(raw));
          break;
        case 1:
          leaf.numbers.push_back(static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw))));
          break;
        case 2:
          leaf.numbers.push_back(static_cast<std::int32_t>(raw));
          break;
        case 3:
          leaf.numbers.push_back(static_cast<std::int16_t>(raw));
          break;
        default:
          leaf.numbers.push_back(static_cast<double>(raw));
      }
    }
    if (type % 10 == 1 && leaf.kind == LeafKind::numbers) {
      leaf.kind = LeafKind::text;
      for (const double code : leaf.numbers) leaf.text += code >= 32.0 && code < 127.0 ? static_cast<char>(code) : ' ';
      leaf.numbers.clear();
    }
    at += static_cast<std::size_t>(count * size * (complex ? 2 : 1));
    leaves.push_back(std::move(leaf));
  }
  return leaves;
}

}  // namespace host_sim
