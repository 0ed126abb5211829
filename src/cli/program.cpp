// SPDX-License-Identifier: MIT
#include "spume/cli/program.hpp"

#include <omp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <map>
#include <new>

#include "spume/core/error.hpp"
#include "spume/run/version.hpp"
#include "verbs.hpp"

namespace spume {
namespace {

// The OpenMP runtime aborts when it cannot create its threads, which happens far above this number.
constexpr int most_threads = 1024;

void use_threads(const std::optional<int>& threads) {
  const int wanted = threads.value_or(omp_get_max_threads());
  if (wanted < 1 || wanted > most_threads)
    throw InputError((threads ? "--threads is " : "OMP_NUM_THREADS is ") + std::to_string(wanted) +
                     "; give a number of threads from 1 to " + std::to_string(most_threads));
  omp_set_num_threads(wanted);
}

// Every message of an InputError is complete; several get a last line that counts them.
void print_problems(const InputError& error) {
  std::fprintf(stderr, "%s\n", error.what());
  const auto& problems = error.problems();
  if (problems.size() < 2) return;
  const std::string& file = problems.front().file;
  const bool one_file = !file.empty() && std::all_of(problems.begin(), problems.end(),
                                                     [&](auto& problem) { return problem.file == file; });
  std::fprintf(stderr, "%zu problems%s; nothing was run\n", problems.size(), one_file ? (" in " + file).c_str() : "");
}

// What such a verb prints is all that it leaves: on a full disk it is lost, and the exit code has to tell.
int with_output_written(int code) {
  const bool failed = std::fflush(stdout) != 0 || std::ferror(stdout) != 0;
  if (!failed || code != exit_done) return code;
  std::fprintf(stderr, "error: the output could not be written; is the disk full?\n");
  return exit_input;
}

struct CommandLine {
  CLI::App app{"Spume simulates bubbly flows with particles and spectra."};
  RunArguments run;
  std::optional<int> threads;
  std::string file, section;
  std::vector<std::string> cases, pictured;
  std::map<std::string, std::vector<std::string>> picture_options;  // passed on as they are
  bool animate = false;
  bool quick = false;
  std::string keep;
  bool table_only = false;
  ViewArguments view;
  CLI::App *run_app, *check_app, *resume_app, *info_app, *verify_app, *plot_app, *compare_app, *view_app, *options_app;

  CommandLine() {
    app.name("spume");
    app.require_subcommand(1);
    app.set_version_flag("--version", "Spume " + program_version() + " (" + program_commit() + ")");
    run_app = app.add_subcommand("run", "validate a case, run it, record the results");
    check_app = app.add_subcommand("check", "everything but running: the plan, memory and time estimate");
    resume_app = app.add_subcommand("resume", "continue a run bit for bit from its last checkpoint");
    info_app = app.add_subcommand("info", "what a result, a checkpoint, a run folder or a case holds");
    verify_app = app.add_subcommand("verify", "run validation cases and print error against bound");
    plot_app =
        app.add_subcommand("plot", "pictures of a run, of two runs beside each other, or of those that verify kept");
    compare_app = app.add_subcommand("compare", "two runs side by side: cost, options, verdicts, quantities; pictures");
    view_app = app.add_subcommand("view", "results in a browser: of a run, of two beside each other, or of a file");
    options_app = app.add_subcommand("options", "every option of a case: unit, default, range");

    for (CLI::App* verb : {run_app, check_app}) {
      verb->add_option("case", run.input, "case file, folder that holds its case.toml, or name of a case")->required();
      verb->add_option("--set", run.overrides, "section.key=value: replaces a value of the case; may be repeated")
          ->take_all()
          ->expected(1)
          ->allow_extra_args(false);
    }
    for (CLI::App* verb : {run_app, resume_app}) {
      CLI::Option* const view =
          verb->add_flag("--view", run.view, "show the run in a browser: prints the address of the page");
      verb->add_option("--port", run.port, "port of the page (default: a free one)")
          ->check(CLI::Range(1, 65535))
          ->needs(view);
      verb->add_flag("--paused", run.paused, "with --view: paused before the first step")->needs(view);
    }
    run_app->add_option("--replay", run.replay, "steering.csv of a run: makes the same changes after the same steps");
    run_app->add_option("-o,--output", run.folder, "new folder for the results (default: runs/<case>-<n>)");
    resume_app->add_option("dir", run.input, "folder of the run")->required();
    for (CLI::App* verb : {run_app, resume_app}) {
      verb->add_option("--until", run.until, "end time instead of the case's");
      verb->add_flag("-q,--quiet", run.quiet, "print nothing but errors");
    }
    for (CLI::App* verb : {run_app, check_app, resume_app, verify_app})
      verb->add_option("--threads", threads, "number of threads (default: all cores)");
    info_app->add_option("file", file, "result, checkpoint, run folder or case")->required();
    verify_app->add_option("cases", cases, "names or folders of cases (default: all)");
    verify_app->add_flag("--quick", quick, "only what takes seconds");
    verify_app->add_option("--keep", keep, "keep the runs, their plots and verify.json in this folder");
    plot_app->add_option("dir", pictured, "folder of a run, of two runs, or of the runs of a case that verify kept")
        ->required()
        ->expected(1, 2);
    const auto pass_on = [&](const char* name, const char* description, const char* takes) {
      return plot_app->add_option(name, picture_options[name], description)->type_name(takes);
    };
    pass_on("--fields", "fields drawn in a plane: those of the snapshots, speed, enstrophy, velocity_x ...",
            "NAME ...");
    pass_on("--times", "times of the snapshots that are drawn", "T ...");
    pass_on("--plane", "plane of the fields in 3-D, such as y=0.5; default: the middle y", "AXIS=VALUE")->expected(1);
    pass_on("--range", "limits of the colours of a field, such as speed=0:2", "FIELD=LOW:HIGH ...");
    pass_on("--format", "of the pictures: png, pdf or svg; default: png", "WORD")->expected(1);
    compare_app->add_option("dir", pictured, "folders of two runs")->required()->expected(2);
    compare_app->add_flag("--no-pictures", table_only, "print the table alone");
    plot_app->add_flag("--animate", animate,
                       "GIFs of all snapshots, with ffmpeg MP4s too, in place of pictures of some");
    view_app
        ->add_option("dir", view.paths,
                     "folder of a run, of two runs, or VTKHDF or H5Part files; a run may still go on")
        ->required()
        ->expected(1, 2);
    view_app->add_option("--port", view.port, "port of the page (default: a free one)")->check(CLI::Range(1, 65535));
    options_app->add_option("section", section, "only this section");
  }

  std::string parse_failure(int argc, char** argv, const CLI::ParseError& error) const {
    const auto verbs = app.get_subcommands([](const CLI::App*) { return true; });
    std::string names;
    for (const CLI::App* verb : verbs) names += (names.empty() ? "" : ", ") + verb->get_name();
    if (argc < 2) return "a verb is missing; there are " + names;
    const bool known = std::any_of(verbs.begin(), verbs.end(), [&](auto* verb) { return verb->get_name() == argv[1]; });
    if (!known && argv[1][0] != '-') return "unknown verb '" + std::string(argv[1]) + "'; there are " + names;
    return error.what();
  }

  std::vector<std::string> plot_arguments() const {
    std::vector<std::string> arguments = pictured;
    for (const auto& [name, values] : picture_options) {
      if (values.empty()) continue;
      arguments.push_back(name);
      arguments.insert(arguments.end(), values.begin(), values.end());
    }
    if (animate) arguments.push_back("--animate");
    return arguments;
  }

  int execute(const Program& program) {
    use_threads(threads);
    if (run_app->parsed()) return run_verb(run, program);
    if (check_app->parsed()) return with_output_written(check_verb(run, program));
    if (resume_app->parsed()) return resume_verb(run, program);
    if (info_app->parsed()) return with_output_written(info_verb(file, program));
    if (options_app->parsed()) return with_output_written(options_verb(section, program));
    if (view_app->parsed()) return view_verb(view);
    if (plot_app->parsed()) return module_verb("plots", plot_arguments());
    if (compare_app->parsed()) {
      if (table_only) pictured.emplace_back("--no-pictures");
      return module_verb("compare", pictured);
    }
    std::vector<std::string> arguments = {own_executable()};
    arguments.insert(arguments.end(), cases.begin(), cases.end());
    if (quick) arguments.push_back("--quick");
    if (threads) arguments.insert(arguments.end(), {"--threads", std::to_string(*threads)});
    if (!keep.empty()) arguments.insert(arguments.end(), {"--keep", keep});
    return module_verb("verify", arguments);
  }
};

}  // namespace

int run_program(int argc, char** argv, const Program& program) {
  CommandLine line;
  try {
    line.app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return with_output_written(line.app.exit(error));
    std::fprintf(stderr, "error: %s; see spume --help\n", line.parse_failure(argc, argv, error).c_str());
    return exit_input;
  }
  try {
    return line.execute(program);
  } catch (const InputError& error) {
    print_problems(error);
    return exit_input;
  } catch (const FileError& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return exit_input;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr,
                 "error: not enough memory for this case; increase resolution.spacing, lower resolution.grid or use a "
                 "larger machine\n");
    return exit_input;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return exit_numerical;
  }
}

}  // namespace spume
