// SPDX-License-Identifier: BSD-3-Clause
#include "firmware/boards/stm32h7/emulator/elf_file.hpp"

#include <elf.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "firmware/boards/stm32h7/emulator/processor.hpp"

namespace rosflight::boards::stm32h7::emulator {
namespace {

/// A structure inside the file. @throws ProcessorError if the file ends before.
template <class T>
T at(const std::vector<char>& bytes, std::size_t offset, const std::string& name) {
  if (offset + sizeof(T) > bytes.size()) throw ProcessorError(name + ": the file ends too early");
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

void read_symbols(ElfFile& file, const std::vector<char>& bytes, const Elf32_Ehdr& header,
                  const std::string& name) {
  for (unsigned k = 0; k < header.e_shnum; ++k) {
    const auto section = at<Elf32_Shdr>(bytes, header.e_shoff + k * sizeof(Elf32_Shdr), name);
    if (section.sh_type != SHT_SYMTAB) continue;
    const auto strings =
        at<Elf32_Shdr>(bytes, header.e_shoff + section.sh_link * sizeof(Elf32_Shdr), name);
    for (std::size_t o = 0; o + sizeof(Elf32_Sym) <= section.sh_size; o += sizeof(Elf32_Sym)) {
      const auto symbol = at<Elf32_Sym>(bytes, section.sh_offset + o, name);
      const std::size_t text = strings.sh_offset + symbol.st_name;
      if (text >= bytes.size()) continue;
      file.symbols[std::string(bytes.data() + text,
                               strnlen(bytes.data() + text, bytes.size() - text))] =
          symbol.st_value;
    }
  }
}

}  // namespace

ElfFile ElfFile::read(const std::filesystem::path& path) {
  const std::string name = path.string();
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw ProcessorError(name + ": cannot be read");
  const std::vector<char> bytes((std::istreambuf_iterator<char>(stream)), {});
  const auto header = at<Elf32_Ehdr>(bytes, 0, name);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_machine != EM_ARM) {
    throw ProcessorError(name + ": is no ELF file for Arm");
  }
  ElfFile file;
  for (unsigned k = 0; k < header.e_phnum; ++k) {
    const auto part = at<Elf32_Phdr>(bytes, header.e_phoff + k * sizeof(Elf32_Phdr), name);
    if (part.p_type != PT_LOAD || part.p_filesz == 0) continue;
    if (std::size_t{part.p_offset} + part.p_filesz > bytes.size())
      throw ProcessorError(name + ": the file ends too early");
    Segment segment{part.p_paddr, {}};
    segment.bytes.assign(bytes.begin() + part.p_offset,
                         bytes.begin() + part.p_offset + part.p_filesz);
    file.segments.push_back(std::move(segment));
  }
  if (file.segments.empty()) throw ProcessorError(name + ": has nothing to load");
  read_symbols(file, bytes, header, name);
  return file;
}

}  // namespace rosflight::boards::stm32h7::emulator
