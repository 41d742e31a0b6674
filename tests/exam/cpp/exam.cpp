// The exam as a program of its own.
#include "answers.hpp"

int main(int argc, char** argv) { return exam::answer_problems(argc, argv); }
