#include "cloudbow/core/ranks.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "cloudbow/core/error.hpp"
#ifdef CLOUDBOW_HAS_MPI
#include "cloudbow/core/module.hpp"
#include "core/mpi_module.hpp"
#endif

namespace cloudbow {
namespace {

/// Set by the launchers of Open MPI, MPICH and its relatives, and by Slurm's for PMIx.
struct Launcher {
  const char* size;
  const char* also;  ///< must be set too; null: nothing else
};
constexpr std::array<Launcher, 3> launchers{
    {{"OMPI_COMM_WORLD_SIZE", nullptr}, {"PMI_SIZE", nullptr}, {"SLURM_NTASKS", "PMIX_RANK"}}};

}  // namespace

int launched_processes() {
  for (const Launcher& launcher : launchers) {
    const char* const text = std::getenv(launcher.size);
    if (text == nullptr || (launcher.also != nullptr && std::getenv(launcher.also) == nullptr)) continue;
    int size = 1;
    const auto [end, error] = std::from_chars(text, text + std::strlen(text), size);
    if (error == std::errc() && *end == '\0' && size > 1) return size;
  }
  return 1;
}

std::unique_ptr<Ranks> start_ranks() {
  const int processes = launched_processes();
  if (processes == 1) return nullptr;
#ifdef CLOUDBOW_HAS_MPI
  // Measured: 60 MB of libraries and their buffers. Open MPI starts a thread for its messages.
  const void* const symbol = load_module("cloudbow_mpi.so", "cloudbow_mpi_module",
                                         {"Open MPI", "joins the processes of mpirun", 100'000'000, 2});
  std::unique_ptr<Ranks> ranks = static_cast<const MpiModule*>(symbol)->start();
  // Each process alone would solve the whole run and write the same file.
  if (ranks->size() != processes) {
    throw InputError(fmt::format(
        "mpirun: the processes do not find each other (found {} of {}, allowed all); start them by the mpirun of Open "
        "MPI. In a program that mpirun has started, remove OMPI_COMM_WORLD_SIZE and PMI_SIZE from the environment",
        ranks->size(), processes));
  }
  return ranks;
#else
  throw InputError(fmt::format(
      "mpirun: this build has no MPI (found {} processes, allowed 1) build with -DCLOUDBOW_MPI=ON, or use --part and "
      "--share",
      processes));
#endif
}

void send_bytes(Ranks& ranks, int to, std::span<const std::byte> bytes) {
  const std::array<std::uint64_t, 1> size{bytes.size()};
  const std::array<Ranks::Outgoing, 1> first{{{to, std::as_bytes(std::span(size))}}};
  ranks.exchange(first, {});
  const std::array<Ranks::Outgoing, 1> second{{{to, bytes}}};
  ranks.exchange(second, {});
}

std::vector<std::byte> receive_bytes(Ranks& ranks, int from) {
  std::array<std::uint64_t, 1> size{};
  const std::array<Ranks::Incoming, 1> first{{{from, std::as_writable_bytes(std::span(size))}}};
  ranks.exchange({}, first);
  std::vector<std::byte> bytes(size[0]);
  const std::array<Ranks::Incoming, 1> second{{{from, bytes}}};
  ranks.exchange({}, second);
  return bytes;
}

}  // namespace cloudbow
