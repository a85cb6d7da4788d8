// What the programs by hand have in common: arguments, times, the file of points.
#pragma once
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

// Solves `rows` x `columns` points of `width` numbers again and again and prints one line of JSON with the seconds of each run. `choice` is
// what the argument of that name has where none is given; `solve` takes it, the counts and the points, and gives its evaluations.
template <class Solve>
int run_peer(int count, char** words, const char* name, const char* choice_name, std::string choice, int width, Solve solve) {
    int rows = 31, columns = 61, repetitions = 3;
    std::string out;
    for (int k = 1; k + 1 < count; k += 2) {
        std::string key = words[k];
        if (key == choice_name) choice = words[k + 1];
        if (key == "--n1") rows = std::atoi(words[k + 1]);
        if (key == "--n2") columns = std::atoi(words[k + 1]);
        if (key == "--reps") repetitions = std::atoi(words[k + 1]);
        if (key == "--out") out = words[k + 1];
    }
    std::vector<double> points(width * (size_t)rows * columns);
    std::printf("{\"cand\":\"%s\",\"choice\":\"%s\",\"solve_s\":[", name, choice.c_str());
    double evaluations = 0;
    for (int k = 0; k < repetitions; k++) {
        auto start = std::chrono::steady_clock::now();
        evaluations = solve(choice, rows, columns, points.data());
        std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
        std::printf("%s%.9f", k ? "," : "", time.count());
    }
    std::printf("],\"evals_per_pt\":%.3f}\n", evaluations / ((double)rows * columns));
    if (!out.empty()) {
        FILE* file = std::fopen(out.c_str(), "wb");
        if (!file || std::fwrite(points.data(), 8, points.size(), file) != points.size()) return 1;
        std::fclose(file);
    }
    return 0;
}
