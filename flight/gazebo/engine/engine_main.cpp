// SPDX-License-Identifier: BSD-3-Clause
// Moves a vehicle with Gazebo's physics engine dartsim, in lock-step with gazebo_engine.cpp, which starts it. It ends when
// the pipe of the commands is closed.
//
// usage: gazebo_engine [WORLD]           WORLD: an SDF file
//        gazebo_engine --check FILE...   reads SDF files as Gazebo does and prints the first error of each
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "flight/gazebo/engine/dart_world.hpp"
#include "flight/gazebo/engine/sdf_files.hpp"

namespace {

namespace gazebo = rosflight::flight::gazebo;

int check(const std::vector<std::string>& files) {
  int failed = 0;
  for (const std::string& file : files) {
    try {
      gazebo::read_sdf(file);
    } catch (const std::exception& error) {
      std::cerr << error.what() << "\n";
      failed = 1;
    }
  }
  return failed;
}

std::string read_all(int fd) {
  std::string text(static_cast<std::size_t>(std::max<off_t>(::lseek(fd, 0, SEEK_END), 0)), '\0');
  ::lseek(fd, 0, SEEK_SET);
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t count = ::read(fd, text.data() + done, text.size() - done);
    if (count <= 0) throw std::runtime_error("the model of the vehicle cannot be read");
    done += static_cast<std::size_t>(count);
  }
  return text;
}

void write_files(const gazebo::DartWorld& world) {
  std::string text;
  for (const std::string& file : world.files()) text += file + "\n";
  if (::write(gazebo::kFilesFd, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
    throw std::runtime_error("the list of files cannot be written");
}

void answer(char what) {
  if (::write(gazebo::kAnswersFd, &what, 1) != 1) ::_exit(1);
}

void serve(gazebo::Block& block, const std::string& world_file) {
  std::unique_ptr<gazebo::DartWorld> world;
  for (char command = 0; ::read(gazebo::kCommandsFd, &command, 1) == 1;) {
    if (command == gazebo::kBegin) {
      world = std::make_unique<gazebo::DartWorld>(read_all(gazebo::kModelFd), world_file,
                                                  block.gravity_m_s2);
      write_files(*world);
    } else if (!world) {
      throw std::runtime_error("a command before the beginning");
    } else if (command == gazebo::kMove) {
      world->move(block);
    } else {
      world->set_state(block);
      if (command == gazebo::kPlace) {
        world->check_place(block);
        world->set_state(block);
      }
      world->read_state(block);
    }
    answer(gazebo::kReady);
  }
}

int run(const std::string& world_file) {
  void* const mapped = ::mmap(nullptr, sizeof(gazebo::Block), PROT_READ | PROT_WRITE, MAP_SHARED,
                              gazebo::kBlockFd, 0);
  if (mapped == MAP_FAILED) {
    std::cerr << "gazebo_engine: started by hand; ./rosflight fly --physics gazebo starts it\n";
    return 2;
  }
  auto& block = *static_cast<gazebo::Block*>(mapped);
  try {
    serve(block, world_file);
  } catch (const std::exception& error) {
    const std::string text = error.what();
    block.error.fill('\0');
    std::copy_n(text.begin(), std::min(text.size(), block.error.size() - 1), block.error.begin());
    answer(gazebo::kFailed);
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (!words.empty() && words[0] == "--check") return check({words.begin() + 1, words.end()});
  return run(words.empty() ? "" : words[0]);
}
