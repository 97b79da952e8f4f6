// Recordings as MATLAB files, by matio.
//
// A damaged file can crash matio and HDF5 (several such defects of the versions in Debian 12 are public). The file is
// therefore read in a child process that sends the vectors through a pipe; a crash of the child is an unreadable file.
// The libraries may also stop early without an error. A count detects this: the elements of a MATLAB 5 file fill it
// exactly, and the number of variables read must equal the number of elements.
#include <matio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/values/channel_map.hpp"
#include "firmware/recording/column_targets.hpp"
#include "firmware/recording/output_file.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/recording/recording_gaps.hpp"
#include "firmware/recording/sample_checks.hpp"

#if defined(__SANITIZE_ADDRESS__)
#define RIGTWIN_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define RIGTWIN_ADDRESS_SANITIZER 1
#endif
#endif

namespace host_sim {
namespace {

constexpr std::string_view a_whole_file = "a whole MATLAB 5 or 7.3 file";
constexpr rlim_t most_memory = rlim_t{4} << 30U;  // [byte]: what a damaged length may make the libraries ask for
constexpr rlim_t most_processor_time = 120;       // [s]: a damaged file may make them go round in circles

struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, FreeVariable>;
struct CloseFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
using MatFile = std::unique_ptr<mat_t, CloseFile>;

// --- Structure of a MATLAB 5 file, without the libraries --------------------------------------------------------

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
                                 a_whole_file);
    }
    if (type != MAT_T_MATRIX && type != MAT_T_COMPRESSED) {
      throw firmware::InputError(source, 0, "the file is damaged at variable " + std::to_string(elements + 1),
                                 a_whole_file);
    }
    at = end;
  }
  return elements;
}

// --- In the child process: the libraries -----------------------------------------------------------------------

// What the child sends: variables, each a name, a state and, when it is a vector, its numbers; then `end`.
enum class State : std::uint8_t { vector, other, no_vector, complex, end, damaged };

class Sender {
 public:
  explicit Sender(int descriptor) : descriptor_(descriptor) {}

  void send(std::string_view name, State state, const std::vector<double>& numbers = {}) const {
    const std::array<std::uint64_t, 2> sizes{name.size(), numbers.size()};
    send(&state, sizeof state);
    send(sizes.data(), sizeof sizes);
    send(name.data(), name.size());
    send(numbers.data(), numbers.size() * sizeof(double));
  }

 private:
  void send(const void* bytes, std::size_t size) const {
    for (const char* p = static_cast<const char*>(bytes); size > 0;) {
      const ssize_t sent = ::write(descriptor_, p, size);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) ::_exit(1);
      p += sent;
      size -= static_cast<std::size_t>(sent);
    }
  }

  int descriptor_;
};

template <class Number>
std::vector<double> converted(const matvar_t& variable, std::size_t count) {
  const auto* numbers = static_cast<const Number*>(variable.data);
  std::vector<double> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = static_cast<double>(numbers[i]);
  return result;
}

void send_numbers(const Sender& sender, std::string_view name, const matvar_t& variable) {
  std::size_t count = 1;
  int longer_than_one = 0;
  for (int i = 0; i < variable.rank; ++i) {
    const std::size_t length = variable.dims[i];
    if (length != 0 && count > variable.nbytes / length) return sender.send(name, State::damaged);
    count *= length;
    if (length != 1) ++longer_than_one;
  }
  if (variable.isComplex != 0) return sender.send(name, State::complex);
  if (longer_than_one > 1 || count == 0) return sender.send(name, State::no_vector);
  if (variable.data == nullptr || variable.data_size <= 0 ||
      count * static_cast<std::size_t>(variable.data_size) > variable.nbytes) {
    return sender.send(name, State::damaged);
  }
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return sender.send(name, State::vector, converted<double>(variable, count));
    case MAT_C_SINGLE:
      return sender.send(name, State::vector, converted<float>(variable, count));
    case MAT_C_INT8:
      return sender.send(name, State::vector, converted<std::int8_t>(variable, count));
    case MAT_C_UINT8:
      return sender.send(name, State::vector, converted<std::uint8_t>(variable, count));
    case MAT_C_INT16:
      return sender.send(name, State::vector, converted<std::int16_t>(variable, count));
    case MAT_C_UINT16:
      return sender.send(name, State::vector, converted<std::uint16_t>(variable, count));
    case MAT_C_INT32:
      return sender.send(name, State::vector, converted<std::int32_t>(variable, count));
    case MAT_C_UINT32:
      return sender.send(name, State::vector, converted<std::uint32_t>(variable, count));
    case MAT_C_INT64:
      return sender.send(name, State::vector, converted<std::int64_t>(variable, count));
    case MAT_C_UINT64:
      return sender.send(name, State::vector, converted<std::uint64_t>(variable, count));
    default:
      return sender.send(name, State::other);
  }
}

// Every variable of the file; a structure as its fields, called "structure.field". Only wanted ones with their numbers.
void send_variables(const Sender& sender, const char* path, const std::function<bool(std::string_view)>& wanted) {
  const MatFile file(Mat_Open(path, MAT_ACC_RDONLY));
  if (!file) return sender.send("", State::damaged);
  const auto send = [&](const std::string& name, const matvar_t& variable) {
    wanted(name) ? send_numbers(sender, name, variable) : sender.send(name, State::other);
  };
  std::size_t count = 0;
  while (const Variable variable{Mat_VarReadNext(file.get())}) {
    ++count;
    const std::string name = variable->name == nullptr ? "" : variable->name;
    const bool single = variable->rank == 2 && variable->dims[0] == 1 && variable->dims[1] == 1;
    if (variable->class_type != MAT_C_STRUCT || !single) {
      send(name, *variable);
      continue;
    }
    char* const* fields = Mat_VarGetStructFieldnames(variable.get());
    for (unsigned i = 0; fields != nullptr && i < Mat_VarGetNumberOfFields(variable.get()); ++i) {
      const matvar_t* field = Mat_VarGetStructFieldByIndex(variable.get(), i, 0);
      if (field != nullptr && fields[i] != nullptr) send(name + "." + fields[i], *field);
    }
  }
  sender.send(std::to_string(count), State::end);
}

[[noreturn]] void be_child(int descriptor, const std::string& path,
                           const std::function<bool(std::string_view)>& wanted) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL}) {
    std::signal(signal, SIG_DFL);  // dies of it, and leaves the parent's files alone
  }
  const rlimit no_core{0, 0};
  const rlimit time{most_processor_time, most_processor_time};
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setrlimit(RLIMIT_CPU, &time);
#if !defined(RIGTWIN_ADDRESS_SANITIZER)  // reserves terabytes for itself
  const rlimit memory{most_memory, most_memory};
  ::setrlimit(RLIMIT_DATA, &memory);
#endif
  static_cast<void>(std::freopen("/dev/null", "w", stderr));  // what HDF5 has to say about a damaged file
  try {
    send_variables(Sender(descriptor), path.c_str(), wanted);
    ::_exit(0);
  } catch (...) {
    ::_exit(1);
  }
}

// --- In the parent: what the child sends ------------------------------------------------------------------------

class Receiver {
 public:
  explicit Receiver(int descriptor) : descriptor_(descriptor) {}

  struct Message {
    std::string name;
    State state;
    std::vector<double> numbers;
  };

  // The next message; none when the child has ended without `end`.
  std::optional<Message> receive() const {
    Message message{};
    std::array<std::uint64_t, 2> sizes{};
    if (!receive(&message.state, sizeof message.state) || !receive(sizes.data(), sizeof sizes)) return std::nullopt;
    // A child whose memory is damaged may send anything.
    if (message.state > State::damaged || sizes[0] > most_memory || sizes[1] > most_memory / sizeof(double)) {
      return std::nullopt;
    }
    message.name.resize(sizes[0]);
    message.numbers.resize(sizes[1]);
    if (!receive(message.name.data(), sizes[0])) return std::nullopt;
    if (!receive(message.numbers.data(), sizes[1] * sizeof(double))) return std::nullopt;
    return message;
  }

 private:
  bool receive(void* bytes, std::size_t size) const {
    for (char* p = static_cast<char*>(bytes); size > 0;) {
      const ssize_t got = ::read(descriptor_, p, size);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      p += got;
      size -= static_cast<std::size_t>(got);
    }
    return true;
  }

  int descriptor_;
};

// The child process, ended at the latest when this object is.
class Child {
 public:
  Child(const std::string& path, const std::function<bool(std::string_view)>& wanted) {
    std::array<int, 2> pipe{};
    if (::pipe(pipe.data()) != 0) throw_cannot_start(path);
    process_ = ::fork();
    if (process_ == 0) {
      ::close(pipe[0]);
      be_child(pipe[1], path, wanted);
    }
    ::close(pipe[1]);
    descriptor_ = pipe[0];
    if (process_ < 0) {
      ::close(descriptor_);
      throw_cannot_start(path);
    }
  }
  ~Child() {
    ::close(descriptor_);
    ::kill(process_, SIGKILL);
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  [[noreturn]] static void throw_cannot_start(std::string_view source) {
    throw firmware::InputError(source, 0, std::string("cannot start a process to read it: ") + std::strerror(errno),
                               "a free process");
  }

  pid_t process_ = -1;
  int descriptor_ = -1;
};

std::string header_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text(116, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  return text;
}

std::string_view after_dot(std::string_view name) {
  const std::size_t dot = name.find('.');
  return dot == std::string_view::npos ? name : name.substr(dot + 1);
}

// Fields of a structure stand for themselves in a file whose time is in one: a structure beside a vector t is something
// else, and then only "structure.field" in the map finds its fields.
void read_names(std::vector<firmware::Heading>& headings, const firmware::ChannelMap& map) {
  const auto mapped = map.find("t");
  const std::string_view time = mapped == map.end() ? "t" : std::string_view(mapped->second.column);
  for (const firmware::Heading& heading : headings) {
    if (heading.text == time || heading.text == "t") return;
  }
  for (firmware::Heading& heading : headings) heading.name = after_dot(heading.text);
}

}  // namespace

firmware::Recording read_recording_mat(const std::filesystem::path& path, const firmware::ChannelMap& map,
                                       std::optional<double> expected_rate, firmware::Missing missing) {
  firmware::Recording recording;
  recording.source = path.string();
  const std::string& source = recording.source;
  const auto damaged = [&](std::string_view where) {
    return firmware::InputError(source, 0, "the file is damaged" + std::string(where), a_whole_file);
  };
  const std::optional<std::size_t> elements = count_elements(path, source);

  std::vector<firmware::Heading> headings;
  std::vector<Receiver::Message> variables;
  {
    const Child child(source, [&](std::string_view name) {
      const std::string_view field = after_dot(name);
      return firmware::find_quantity(field) || std::any_of(map.begin(), map.end(), [&](const auto& entry) {
               return entry.second.column == name || entry.second.column == field;
             });
    });
    const Receiver receiver(child.descriptor());
    for (;;) {
      std::optional<Receiver::Message> message = receiver.receive();
      if (!message) throw damaged(variables.empty() ? "" : " after variable " + variables.back().name);
      if (message->state == State::damaged) throw damaged(" in variable " + message->name);
      if (message->state == State::end) {
        if (elements && message->name != std::to_string(*elements)) throw damaged(" after variable " + message->name);
        break;
      }
      headings.push_back({message->name, message->name, std::nullopt});
      variables.push_back(std::move(*message));
    }
  }
  if (variables.empty())
    throw firmware::InputError(source, 0, "no variable can be read", std::string(a_whole_file) + " with a vector t");

  const bool own = header_text(path).find(firmware::recording_mark) != std::string::npos;
  const firmware::ChannelMap in_force = own ? firmware::ChannelMap{} : map;
  read_names(headings, in_force);
  const std::vector<std::optional<firmware::Target>> targets = firmware::find_targets(headings, in_force, source, 0);
  const firmware::RecordingLocation location{source};
  for (std::size_t i = 0; i < variables.size(); ++i) {
    Receiver::Message& variable = variables[i];
    if (!targets[i]) {
      recording.ignored_columns.push_back(variable.name);
      continue;
    }
    constexpr std::string_view numbers = "a vector of real numbers";
    if (variable.state == State::complex) throw firmware::InputError(source, 0, variable.name + " is complex", numbers);
    if (variable.state == State::no_vector)
      throw firmware::InputError(source, 0, variable.name + " is not a vector", numbers);
    if (variable.state == State::other)
      throw firmware::InputError(source, 0, variable.name + " is not numeric", numbers);
    std::vector<double>& column = values(recording, targets[i]->quantity);
    column = std::move(variable.numbers);
    for (std::size_t k = 0; k < column.size(); ++k) {
      column[k] = targets[i]->value(column[k]);
      const bool lost = missing == firmware::Missing::mark && std::isnan(column[k]) &&
                        targets[i]->quantity != firmware::time_quantity;
      if (lost && targets[i]->quantity < firmware::first_duct) continue;
      if (const firmware::Objection objection = firmware::object_to(targets[i]->quantity, column[k])) {
        throw location.error(k, objection.wrong, objection.expected);
      }
    }
  }
  for (firmware::Quantity q = 1; q < firmware::quantity_count; ++q) {
    const std::size_t size = values(recording, q).size();
    if (size == 0 || size == recording.size()) continue;
    throw firmware::InputError(source, 0,
                               std::string(firmware::quantity_name(q)) + " has " + std::to_string(size) + " samples",
                               std::to_string(recording.size()) + " as in t");
  }
  if (missing == firmware::Missing::mark) {
    expected_rate = firmware::rate_if_usual(recording.time, firmware::StampRounding{}, expected_rate);
    fill_gaps(recording, {}, location, expected_rate, missing);
  }
  firmware::check_time(recording, firmware::StampRounding{}, location, expected_rate);
  return recording;
}

void write_recording_mat(const std::filesystem::path& path, const firmware::Recording& recording) {
  firmware::OutputFile output(path);
  if (std::filesystem::exists(output.temporary()) && !std::filesystem::is_regular_file(output.temporary())) {
    throw firmware::OutputError(path.string(), "a MATLAB file cannot be written there", "a regular file");
  }
  const auto require = [&](bool done) {
    if (!done) throw firmware::OutputError(path.string(), "cannot be written", "room for the whole file");
  };
  const std::string header = "MATLAB 5.0 MAT-file, " + std::string(firmware::recording_mark);
  MatFile file(Mat_CreateVer(output.temporary().c_str(), header.c_str(), MAT_FT_MAT5));
  require(file != nullptr);

  std::uintmax_t size = 128;
  const auto write = [&](std::string_view name, const std::vector<double>& numbers) {
    std::array<std::size_t, 2> shape{numbers.size(), 1};
    std::vector<double> data = numbers;  // matio does not promise to leave them alone
    const Variable variable(Mat_VarCreate(std::string(name).c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(),
                                          data.data(), MAT_F_DONT_COPY_DATA));
    require(variable != nullptr && Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_NONE) == 0);
    // Tags of the element and the numbers, flags, shape; the name with its tag, in one if it is short; the numbers.
    size += 8 + 8 + 16 + 16 + (name.size() <= 4 ? 8 : 8 + (name.size() + 7) / 8 * 8) + 8 * numbers.size();
  };
  for (firmware::Quantity q = 0; q < firmware::quantity_count; ++q) {
    if (!values(recording, q).empty()) write(firmware::quantity_name(q), values(recording, q));
  }
  for (const firmware::ExtraColumn& extra : recording.extra) write(extra.name, extra.values);

  // matio does not report a failed write; the file size shows it.
  require(Mat_Close(file.release()) == 0);
  require(std::filesystem::file_size(output.temporary()) == size);
  output.commit();
}

}  // namespace host_sim
