/* Springs and dashpots in parallel, with or without a mass on them; FMI is in fmi2.c and fmi3.c.

   Mount: displacement in, force out. Each arm is a spring k in series with a dashpot k tau:
       F = k_inf x + b v + sum_j k_j (x - y_j),   dy_j/dt = (x - y_j) / tau_j
   Mass: force in, motion out:
       m dv/dt = F - k_inf x - b v - sum_j k_j (x - y_j),   dx/dt = v

   A co-simulation step is exact for an input that is a straight line over the step: from where it
   stood at the end of the last one to (its value) + (its rate) times the step. What is read after
   the step belongs to its end. */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "model.h"

#define PARAMETERS (3 + 2 * ARMS) /* k_inf, b, mass, every k, every tau */
#define OWN (2 * WITH_MASS)       /* x and v of the mass stand before the arms' y */
#define STATES (OWN + ARMS)
#define SIZE (STATES + 2) /* of the matrix of a step: states, input, its rate */

enum { TIME, INPUT, RATE, OUTPUT, FIRST_PARAMETER = 10 };
#define FIRST_STATE (FIRST_PARAMETER + PARAMETERS)
#define FIRST_DERIVATIVE (FIRST_STATE + STATES)

enum stage { INSTANTIATED, INITIALISATION, RUNNING, TERMINATED };
enum outcome { DONE, OUTSIDE_LIMITS, UNKNOWN, LOCKED };

typedef struct {
    int stage, exchange; /* exchange: the importer integrates (Model Exchange) */
    char token[sizeof TOKEN]; /* of this FMU, in every state that it hands out */
    double time, input, rate, derivative; /* the derivative is NAN where the importer set none */
    double at, slope; /* of the input, at the end of the last step */
    double parameter[PARAMETERS], state[STATES + 1];
    double matrix[SIZE * SIZE], step; /* exp(A h) of the last step, and its h */
} Solid;

static void start_solid(Solid *s, int exchange) {
    memset(s, 0, sizeof *s);
    s->exchange = exchange;
    memcpy(s->parameter, START, sizeof s->parameter);
    memcpy(s->token, TOKEN, sizeof s->token);
    s->derivative = NAN;
    s->step = -1;
}

/* Whether an arm under the mass is so fast that it is a dashpot k tau to any motion of the mass: a
   step matrix of such an arm would lose all the rest in rounding. What is left out is 1e-10. */
static int is_dashpot(const Solid *s, int j) {
    double stiffness = s->parameter[0];
    for (int i = 0; i < ARMS; i++) stiffness += s->parameter[3 + i];
    return sqrt(stiffness / s->parameter[2]) * s->parameter[3 + ARMS + j] < 1e-5;
}

/* Force of springs and dashpots at displacement x and velocity v. */
static double restoring_force(const Solid *s, double x, double v) {
    double force = s->parameter[0] * x + s->parameter[1] * v;
    for (int j = 0; j < ARMS; j++)
        force += s->parameter[3 + j] * (x - s->state[OWN + j]);
    return force;
}

/* What the input is now: in co-simulation that of the end of the last step. */
static void present_input(const Solid *s, double *input, double *rate) {
    int held = !s->exchange && s->stage >= RUNNING;
    *input = held ? s->at : s->input;
    *rate = held ? s->slope : s->rate;
}

static void find_derivatives(const Solid *s, double derivative[STATES + 1]) {
    double input, rate;
    present_input(s, &input, &rate);
    double x = WITH_MASS ? s->state[0] : input;
    if (WITH_MASS) {
        derivative[0] = s->state[1];
        derivative[1] = (input - restoring_force(s, x, s->state[1])) / s->parameter[2];
    }
    for (int j = 0; j < ARMS; j++)
        derivative[OWN + j] = (x - s->state[OWN + j]) / s->parameter[3 + ARMS + j];
}

static int read_variable(const Solid *s, unsigned reference, double *value) {
    double input, rate, derivative[STATES + 1];
    present_input(s, &input, &rate);
    if (reference == TIME) *value = s->time;
    else if (reference == INPUT) *value = s->input;
    else if (reference == RATE) *value = s->rate;
    else if (reference == OUTPUT && !WITH_MASS) *value = restoring_force(s, input, rate);
    else if (reference < FIRST_PARAMETER) return UNKNOWN;
    else if (reference < FIRST_STATE) *value = s->parameter[reference - FIRST_PARAMETER];
    else if (reference < FIRST_DERIVATIVE) *value = s->state[reference - FIRST_STATE];
    else if (reference < FIRST_DERIVATIVE + STATES) {
        find_derivatives(s, derivative);
        *value = derivative[reference - FIRST_DERIVATIVE];
    } else return UNKNOWN;
    return DONE;
}

static int write_variable(Solid *s, unsigned reference, double value) {
    if (!isfinite(value)) return OUTSIDE_LIMITS;
    if (reference == INPUT) s->input = value;
    else if (reference == RATE) s->rate = value;
    else if (reference < FIRST_PARAMETER || reference >= FIRST_DERIVATIVE) return UNKNOWN;
    else if (s->stage >= RUNNING && !(s->exchange && reference >= FIRST_STATE)) return LOCKED;
    else if (reference >= FIRST_STATE) s->state[reference - FIRST_STATE] = value;
    else if (value < LEAST[reference - FIRST_PARAMETER]) return OUTSIDE_LIMITS;
    else s->parameter[reference - FIRST_PARAMETER] = value;
    return DONE;
}

static void finish_initialisation(Solid *s) {
    s->at = s->input;
    s->slope = s->rate;
    s->stage = RUNNING;
}

/* matrix = exp(A h), of states, input and its rate: by a series of A h / 2^n, squared n times. */
static void find_step_matrix(Solid *s, double h) {
    static const int n = SIZE;
    double *a = calloc(3 * SIZE * SIZE, sizeof *a), *power, *next, *sum = s->matrix, norm = 0;
    if (!a) { s->step = -1; return; }
    power = a + n * n, next = a + 2 * n * n;
    double column[STATES + 1];
    Solid unit = *s;
    unit.exchange = 1;
    for (int j = 0; j < ARMS; j++) {
        if (!is_dashpot(s, j)) continue;
        unit.parameter[1] += s->parameter[3 + j] * s->parameter[3 + ARMS + j];
        unit.parameter[3 + j] = 0, unit.parameter[3 + ARMS + j] = h; /* no stiff row */
    }
    for (int i = 0; i < STATES + 1; i++) { /* a column of A: the derivatives of a unit state */
        memset(unit.state, 0, sizeof unit.state);
        unit.input = i == STATES;
        if (i < STATES) unit.state[i] = 1;
        find_derivatives(&unit, column);
        for (int row = 0; row < STATES; row++) a[row * n + i] = h * column[row];
    }
    a[(n - 2) * n + n - 1] = h;
    for (int row = 0; row < n; row++) {
        double total = 0;
        for (int i = 0; i < n; i++) total += fabs(a[row * n + i]);
        if (total > norm) norm = total;
    }
    int halvings = 0;
    for (; norm > 0.5 && halvings < 1000; norm /= 2) halvings++;
    for (int i = 0; i < n * n; i++) a[i] = ldexp(a[i], -halvings);
    memset(sum, 0, n * n * sizeof *sum);
    for (int i = 0; i < n; i++) sum[i * n + i] = power[i * n + i] = 1;
    for (int term = 1; term <= 16 + halvings; term++) {
        int squaring = term > 16;
        const double *left = squaring ? sum : power, *right = squaring ? sum : a;
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                double total = 0;
                for (int k = 0; k < n; k++) total += left[i * n + k] * right[k * n + j];
                next[i * n + j] = squaring ? total : total / term;
            }
        if (squaring) memcpy(sum, next, n * n * sizeof *sum);
        else {
            memcpy(power, next, n * n * sizeof *power);
            for (int i = 0; i < n * n; i++) sum[i] += power[i];
        }
    }
    s->step = h;
    free(a);
}

/* One co-simulation step: exact for an input that is a straight line. */
static int advance(Solid *s, double time, double h) {
    double rate = isnan(s->derivative) ? s->rate : s->derivative;
    double before = s->at, after = s->input + rate * h;
    if (!isfinite(time) || !isfinite(h) || h < 0 || !isfinite(after)) return OUTSIDE_LIMITS;
    double slope = h > 0 ? (after - before) / h : rate;
    if (WITH_MASS && h > 0) {
        double old[SIZE];
        if (h != s->step) find_step_matrix(s, h);
        if (h != s->step) return UNKNOWN; /* no memory */
        memcpy(old, s->state, STATES * sizeof *old);
        old[STATES] = before, old[STATES + 1] = slope;
        for (int i = 0; i < STATES; i++) {
            s->state[i] = 0;
            for (int j = 0; j < SIZE; j++) s->state[i] += s->matrix[i * SIZE + j] * old[j];
        }
        for (int j = 0; j < ARMS; j++)
            if (is_dashpot(s, j))
                s->state[OWN + j] = s->state[0] - s->parameter[3 + ARMS + j] * s->state[1];
    }
    for (int j = 0; j < ARMS && !WITH_MASS; j++) { /* stretch of the spring: slope tau in the end */
        double tau = s->parameter[3 + ARMS + j], stretch = before - s->state[j];
        stretch = h > 0 ? stretch * exp(-h / tau) - slope * tau * expm1(-h / tau)
                        : stretch + after - before;
        s->state[j] = after - stretch;
    }
    s->at = after, s->slope = slope, s->derivative = NAN, s->time = time + h;
    return DONE;
}
