#include "host_sim/recording_files/binary/hdf5_leaves.hpp"

#define H5_USE_110_API  // one interface in HDF5 1.10 (Debian 12) and 1.14 (Debian 13)
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace host_sim {
namespace {

constexpr std::string_view a_whole_hdf5_file = "a whole HDF5 file";
constexpr hsize_t most_elements_of_set = hsize_t{1} << 28U;  // 2 GiB of doubles, half the child's memory
constexpr std::size_t most_objects = 10000;

// An identifier of the library, closed by its own function.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] explicit operator bool() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

struct Walk {
  const LeafSender* sender;
  std::size_t count = 0;
};

std::vector<std::size_t> shape_of(hid_t space) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank <= 0 || rank > 32) return {};
  std::array<hsize_t, 32> lengths{};
  H5Sget_simple_extent_dims(space, lengths.data(), nullptr);
  return {lengths.begin(), lengths.begin() + rank};
}

// HDF5's last index runs fastest; a Leaf's first does.
void reorder(Leaf& leaf) {
  if (leaf.shape.size() != 2 || leaf.shape[0] * leaf.shape[1] != leaf.numbers.size()) return;
  const std::size_t n = leaf.shape[0];
  const std::size_t m = leaf.shape[1];
  std::vector<double> columns(leaf.numbers.size());
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = 0; c < m; ++c) columns[r + c * n] = leaf.numbers[r * m + c];
  }
  leaf.numbers = std::move(columns);
}

// Texts of any kind, one a line; `read` fills a buffer of the given memory type.
template <class Read>
std::string read_texts(hid_t type, std::size_t count, const Read& read) {
  std::string text;
  if (count == 0 || count > 4096) return text;
  if (H5Tis_variable_str(type) > 0) {
    const Handle memory(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(memory.get(), H5T_VARIABLE);
    H5Tset_cset(memory.get(), H5Tget_cset(type));
    std::vector<char*> pointers(count, nullptr);
    if (read(memory.get(), static_cast<void*>(pointers.data())) < 0) return text;
    for (std::size_t i = 0; i < count; ++i) {
      text += (i == 0 ? "" : "\n") + std::string(pointers[i] == nullptr ? "" : pointers[i]);
      H5free_memory(pointers[i]);
    }
    return text;
  }
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > 65536) return text;
  const Handle memory(H5Tcopy(type), H5Tclose);
  std::string bytes(size * count, '\0');
  if (read(memory.get(), static_cast<void*>(bytes.data())) < 0) return text;
  for (std::size_t i = 0; i < count; ++i) {
    std::string one = bytes.substr(i * size, size);
    one = one.substr(0, one.find('\0'));
    while (!one.empty() && one.back() == ' ') one.pop_back();
    text += (i == 0 ? "" : "\n") + one;
  }
  return text;
}

herr_t send_attribute(hid_t object, const char* name, const H5A_info_t* /*info*/, void* context) {
  auto& [path, walk] = *static_cast<std::pair<std::string, Walk*>*>(context);
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  if (!attribute) return 0;
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose);
  const hssize_t points = H5Sget_simple_extent_npoints(space.get());
  if (points < 1 || points > 4096) return 0;
  Leaf leaf{path + "@" + name};
  const auto count = static_cast<std::size_t>(points);
  const H5T_class_t of = H5Tget_class(type.get());
  if (of == H5T_STRING) {
    leaf.kind = LeafKind::text;
    leaf.text = read_texts(type.get(), count,
                           [&](hid_t memory, void* buffer) { return H5Aread(attribute.get(), memory, buffer); });
  } else if (of == H5T_INTEGER || of == H5T_FLOAT) {
    leaf.kind = LeafKind::numbers;
    leaf.shape = {count};
    leaf.numbers.resize(count);
    if (H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, leaf.numbers.data()) < 0) return 0;
  } else {
    return 0;
  }
  walk->sender->send(leaf);
  return 0;
}

bool is_numeric(hid_t type) {
  const H5T_class_t of = H5Tget_class(type);
  return of == H5T_INTEGER || of == H5T_FLOAT;
}

void send_compound(const Walk& walk, const std::string& path, hid_t set, hid_t type,
                   const std::vector<std::size_t>& shape, std::size_t count) {
  const int members = H5Tget_nmembers(type);
  for (unsigned i = 0; members > 0 && i < static_cast<unsigned>(members) && i < 256; ++i) {
    const Handle member(H5Tget_member_type(type, i), H5Tclose);
    char* name = H5Tget_member_name(type, i);
    if (name != nullptr && member && is_numeric(member.get())) {
      const Handle memory(H5Tcreate(H5T_COMPOUND, sizeof(double)), H5Tclose);
      H5Tinsert(memory.get(), name, 0, H5T_NATIVE_DOUBLE);
      Leaf leaf{path + "/" + name, LeafKind::numbers, shape, std::vector<double>(count)};
      if (H5Dread(set, memory.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, leaf.numbers.data()) >= 0) walk.sender->send(leaf);
    }
    H5free_memory(name);
  }
}

void send_set(const Walk& walk, const std::string& path, hid_t set) {
  const Handle type(H5Dget_type(set), H5Tclose);
  const Handle space(H5Dget_space(set), H5Sclose);
  const hssize_t points = H5Sget_simple_extent_npoints(space.get());
  Leaf leaf{path};
  leaf.shape = shape_of(space.get());
  if (points < 0 || static_cast<hsize_t>(points) > most_elements_of_set) return walk.sender->send(leaf);
  const auto count = static_cast<std::size_t>(points);
  if (H5Tget_class(type.get()) == H5T_COMPOUND) return send_compound(walk, path, set, type.get(), leaf.shape, count);
  if (is_numeric(type.get())) {
    leaf.kind = LeafKind::numbers;
    leaf.numbers.resize(count);
    if (count > 0 && H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, leaf.numbers.data()) < 0) {
      return walk.sender->send({path, LeafKind::damaged});
    }
    reorder(leaf);
  } else if (H5Tget_class(type.get()) == H5T_STRING) {
    leaf.kind = LeafKind::text;
    leaf.text = read_texts(type.get(), count, [&](hid_t memory, void* buffer) {
      return H5Dread(set, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
    });
  }
  walk.sender->send(leaf);
}

herr_t visit(hid_t root, const char* name, const H5O_info_t* info, void* context) {
  auto* walk = static_cast<Walk*>(context);
  if (++walk->count > most_objects) return 1;
  const std::string path = std::string(name) == "." ? "" : "/" + std::string(name);
  const Handle object(H5Oopen(root, name, H5P_DEFAULT), H5Oclose);
  if (!object) return 0;
  if (info->type == H5O_TYPE_DATASET) send_set(*walk, path, object.get());
  std::pair<std::string, Walk*> of{path, walk};
  H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, send_attribute, &of);
  return 0;
}

void send_all_sets(const LeafSender& sender, const char* path) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Handle file(H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file) return sender.send({"", LeafKind::damaged});
  Walk walk{&sender};
  if (H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_NATIVE, visit, &walk, H5O_INFO_BASIC) < 0) {
    return sender.send({"", LeafKind::damaged});
  }
  sender.finish(walk.count);
}

// netCDF's value for what was never written, where no attribute states another.
constexpr double netcdf_fill = 9.9692099683868690e+36;

// Scaling as netCDF stores it beside a variable:   value = scale_factor × stored + add_offset, NaN where the stored
// value is _FillValue or missing_value. Source: NetCDF Users Guide, appendix A, attribute conventions.
void apply_stored_scaling(std::vector<Leaf>& leaves) {
  const auto attribute = [&](const Leaf& leaf, std::string_view name) -> std::optional<double> {
    const std::string path = leaf.path + "@" + std::string(name);
    const auto found =
        std::find_if(leaves.begin(), leaves.end(), [&](const Leaf& other) { return other.path == path; });
    if (found == leaves.end() || found->numbers.size() != 1) return std::nullopt;
    return found->numbers[0];
  };
  for (Leaf& leaf : leaves) {
    if (leaf.kind != LeafKind::numbers || leaf.path.find('@') != std::string::npos) continue;
    const std::optional<double> fill = attribute(leaf, "_FillValue");
    const std::optional<double> missing = attribute(leaf, "missing_value");
    const double scale = attribute(leaf, "scale_factor").value_or(1.0);
    const double offset = attribute(leaf, "add_offset").value_or(0.0);
    for (double& value : leaf.numbers) {
      if ((fill && value == *fill) || (missing && value == *missing) || value == netcdf_fill) {
        value = std::numeric_limits<double>::quiet_NaN();
      } else if (scale != 1.0 || offset != 0.0) {
        value = scale * value + offset;
      }
    }
  }
}

}  // namespace

std::vector<Leaf> read_hdf5_leaves(const std::filesystem::path& file) {
  const std::string source = file.string();
  std::vector<Leaf> leaves = read_isolated(source, a_whole_hdf5_file, [&](const LeafSender& sender) {
                               send_all_sets(sender, source.c_str());
                             }).leaves;
  apply_stored_scaling(leaves);
  return leaves;
}

}  // namespace host_sim
