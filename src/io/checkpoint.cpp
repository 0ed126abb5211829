// SPDX-License-Identifier: MIT
#include "spume/io/checkpoint.hpp"

#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "spume/core/error.hpp"
#include "spume/io/file.hpp"
#include "spume/io/hdf5.hpp"

namespace spume {
namespace {

using hdf5::File;
using hdf5::Id;

constexpr std::size_t block_bytes = 512;
constexpr const char* mark = "SPUME CHECKPOINT";

struct Stream {
  std::FILE* file;
  Stream(const std::filesystem::path& path, const char* mode) : file(std::fopen(path.c_str(), mode)) {
    if (file == nullptr) throw_file_error(path, mode[0] == 'r' && mode[1] != '+' ? "open" : "write", errno);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() { std::fclose(file); }
};

struct Sum {
  std::uint64_t bytes = 0;
  std::uint32_t crc = 0;
};

// Of everything after the first block; `stream` stands at its end.
Sum sum_of(const Stream& stream, const std::filesystem::path& path) {
  Sum sum{block_bytes, static_cast<std::uint32_t>(::crc32(0, nullptr, 0))};
  std::vector<unsigned char> buffer(1 << 20);
  while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), stream.file)) {
    sum.crc = static_cast<std::uint32_t>(::crc32_z(sum.crc, buffer.data(), got));
    sum.bytes += got;
  }
  if (std::ferror(stream.file)) throw_file_error(path, "read", errno);
  return sum;
}

void write_first_block(const std::filesystem::path& path) {
  const Stream stream(path, "r+b");
  if (std::fseek(stream.file, block_bytes, SEEK_SET) != 0) throw_file_error(path, "read", errno);
  const Sum sum = sum_of(stream, path);
  char block[block_bytes] = {};
  std::snprintf(block, sizeof block, "%s\nformat %d\nbytes %llu\ncrc32 %08x\n", mark, checkpoint_format,
                static_cast<unsigned long long>(sum.bytes), sum.crc);
  std::rewind(stream.file);
  if (std::fwrite(block, 1, sizeof block, stream.file) != sizeof block || std::fflush(stream.file) != 0)
    throw_file_error(path, "write", errno);
}

void verify(const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& reason) {
    throw FileError("cannot read checkpoint '" + path.string() + "': " + reason);
  };
  if (std::filesystem::is_directory(path)) refuse("it is a folder");
  const Stream stream(path, "rb");
  char block[block_bytes + 1] = {};
  const std::size_t got = std::fread(block, 1, block_bytes, stream.file);
  if (std::strncmp(block, mark, std::strlen(mark)) != 0)
    refuse(got == 0 ? "the file is empty" : "it is not a Spume checkpoint");
  if (got < block_bytes) refuse("it is cut short");
  std::istringstream words(block + std::strlen(mark));
  std::string format_word, bytes_word, crc_word, crc;
  int format = 0;
  std::uint64_t bytes = 0;
  words >> format_word >> format >> bytes_word >> bytes >> crc_word >> crc;
  if (!words || format_word != "format" || bytes_word != "bytes" || crc_word != "crc32") refuse("its head is damaged");
  if (format != checkpoint_format)
    refuse("it is written in format " + std::to_string(format) + ", this program reads format " +
           std::to_string(checkpoint_format) + "; resume with the program version that wrote it");
  const Sum sum = sum_of(stream, path);
  if (sum.bytes < bytes)
    refuse("it is cut short: " + std::to_string(sum.bytes) + " of " + std::to_string(bytes) + " bytes");
  char expected[9];
  std::snprintf(expected, sizeof expected, "%08x", sum.crc);
  if (sum.bytes > bytes || crc != expected) refuse("it is damaged: the checksum does not match the contents");
}

std::string stored_name(const std::string& name) {
  return "/state/" + name;
}

void write_array(const File& file, const std::string& name, hid_t file_type, hid_t memory_type, std::size_t size,
                 const void* values) {
  const hsize_t count = size;
  const Id space = file.take(H5Screate_simple(1, &count, nullptr), H5Sclose, "write");
  hdf5::make_groups(file, stored_name(name));
  const Id data = file.take(H5Dcreate2(file.id(), stored_name(name).c_str(), file_type, space, H5P_DEFAULT,
                                       hdf5::dataset_creation(), H5P_DEFAULT),
                            H5Dclose, "write '" + name + "' to");
  if (size > 0) file.check(H5Dwrite(data, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write");
}

H5T_class_t type_class(const File& file, hid_t data) {
  const Id type = file.take(H5Dget_type(data), H5Tclose, "read");
  return H5Tget_class(type);
}

hsize_t element_count(const File& file, hid_t data) {
  const Id space = file.take(H5Dget_space(data), H5Sclose, "read");
  return static_cast<hsize_t>(H5Sget_simple_extent_npoints(space));
}

template <class T>
void read_array(const File& file, const std::string& name, H5T_class_t wanted, hid_t memory_type, Array<T>& values) {
  const auto refuse = [&](const std::string& reason) {
    throw FileError("cannot read checkpoint '" + file.path().string() + "': " + reason);
  };
  if (!file.exists(stored_name(name))) refuse("it has no array '" + name + "'");
  const Id data = file.dataset(stored_name(name));
  if (type_class(file, data) != wanted)
    refuse("array '" + name + "' is not of type " + (wanted == H5T_FLOAT ? "float64" : "int64"));
  values.resize(element_count(file, data));
  if (!values.empty()) file.check(H5Dread(data, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), "read");
}

}  // namespace

struct CheckpointWriter::Open {
  File file;
};

CheckpointWriter::CheckpointWriter(const std::filesystem::path& path, const CheckpointOrigin& origin)
    : path_(path), temporary_(path.string() + ".part") {
  try {
    open_.reset(new Open{File::create(temporary_, File::Format::latest, block_bytes)});
    hdf5::write_text(open_->file, "/origin/program_version", origin.program_version);
    hdf5::write_text(open_->file, "/origin/commit", origin.commit);
    hdf5::write_text(open_->file, "/origin/case", origin.case_text);
    hdf5::write_text(open_->file, "/origin/case_file", origin.case_file);
  } catch (...) {
    ::unlink(temporary_.c_str());
    throw;
  }
}

CheckpointWriter::~CheckpointWriter() {
  open_.reset();
  ::unlink(temporary_.c_str());
}

void CheckpointWriter::f64(const std::string& name, std::span<const double> values) {
  write_array(open_->file, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.size(), values.data());
}

void CheckpointWriter::i64(const std::string& name, std::span<const std::int64_t> values) {
  write_array(open_->file, name, H5T_STD_I64LE, H5T_NATIVE_INT64, values.size(), values.data());
}

void CheckpointWriter::commit() {
  open_->file.close();
  write_first_block(temporary_);
  sync_and_rename(temporary_, path_);
}

struct CheckpointReader::Open {
  File file;
};

CheckpointReader::CheckpointReader(const std::filesystem::path& path) : path_(path) {
  verify(path);
  open_.reset(new Open{File::open(path, false)});
  origin_.program_version = hdf5::read_text(open_->file, "/origin/program_version");
  origin_.commit = hdf5::read_text(open_->file, "/origin/commit");
  origin_.case_text = hdf5::read_text(open_->file, "/origin/case");
  if (open_->file.exists("/origin/case_file")) origin_.case_file = hdf5::read_text(open_->file, "/origin/case_file");
}

CheckpointReader::~CheckpointReader() = default;

bool CheckpointReader::has(const std::string& name) const {
  return open_->file.exists(stored_name(name));
}

void CheckpointReader::f64(const std::string& name, Array<double>& values) const {
  read_array(open_->file, name, H5T_FLOAT, H5T_NATIVE_DOUBLE, values);
}

void CheckpointReader::i64(const std::string& name, Array<std::int64_t>& values) const {
  read_array(open_->file, name, H5T_INTEGER, H5T_NATIVE_INT64, values);
}

std::vector<CheckpointReader::Entry> CheckpointReader::entries() const {
  const File& file = open_->file;
  const Id state = file.take(H5Gopen2(file.id(), "/state", H5P_DEFAULT), H5Gclose, "read");
  std::vector<std::string> names;
  const auto collect = [](hid_t, const char* name, const H5O_info_t* info, void* data) -> herr_t {
    if (info->type == H5O_TYPE_DATASET) static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  file.check(H5Ovisit(state, H5_INDEX_NAME, H5_ITER_INC, collect, &names), "read");
  std::vector<Entry> entries;
  for (const auto& name : names) {
    const Id data = file.dataset(stored_name(name));
    entries.push_back({name, type_class(file, data) == H5T_FLOAT ? "f64" : "i64",
                       static_cast<std::int64_t>(element_count(file, data))});
  }
  return entries;
}

}  // namespace spume
