"""A small FMU, compiled here: a body that cools down, and may fail in every way."""

import shutil
import subprocess
import zipfile

import pytest

DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Cooling.Body" guid="{{cooling}}"
    description="A body that cools down">
  <CoSimulation modelIdentifier="cooling" canHandleVariableCommunicationStepSize="true"/>
  <TypeDefinitions>
    <SimpleType name="Rate"><Real unit="1/s" min="0" max="50"/></SimpleType>
  </TypeDefinitions>
  {experiment}
  <ModelVariables>
    <ScalarVariable name="body.rate" valueReference="0" causality="parameter" variability="fixed"
        description="rate of cooling"><Real declaredType="Rate" start="0.5"/></ScalarVariable>
    <ScalarVariable name="T0" valueReference="1" causality="parameter" variability="tunable">
      <Real unit="K" start="400" max="1.7976931348623157E+308"/></ScalarVariable>
    <ScalarVariable name="fault" valueReference="2" causality="parameter" variability="fixed">
      <Real start="0"/></ScalarVariable>
    <ScalarVariable name="T" valueReference="3" causality="output" variability="continuous"
        description="temperature"><Real unit="K"/></ScalarVariable>
    <ScalarVariable name="steps" valueReference="4" causality="local" variability="continuous">
      <Real/></ScalarVariable>
    <ScalarVariable name="label" valueReference="5" causality="parameter" variability="fixed">
      <String start="a"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure><Outputs><Unknown index="4"/></Outputs></ModelStructure>
</fmiModelDescription>
"""

DESCRIPTION_3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Cooling.Body" instantiationToken="{{cooling}}"
    description="A body that cools down">
  <CoSimulation modelIdentifier="cooling" canHandleVariableCommunicationStepSize="true"/>
  <TypeDefinitions><Float64Type name="Rate" unit="1/s" min="0" max="50"/></TypeDefinitions>
  {experiment}
  <ModelVariables>
    <Float64 name="time" valueReference="9" causality="independent" variability="continuous"/>
    <Float64 name="body.rate" valueReference="0" causality="parameter" variability="fixed"
        description="rate of cooling" declaredType="Rate" start="0.5"/>
    <Float32 name="T0" valueReference="1" causality="parameter" variability="tunable"
        unit="K" start="400" max="1.7976931348623157E+308"/>
    <Float64 name="fault" valueReference="2" causality="parameter" variability="fixed" start="0"/>
    <Float64 name="T" valueReference="3" causality="output" variability="continuous"
        description="temperature" unit="K" initial="calculated"/>
    <Float32 name="steps" valueReference="4" causality="output" variability="continuous"
        initial="calculated"/>
    <Float64 name="field" valueReference="5" causality="output" initial="calculated">
      <Dimension start="2"/></Float64>
    <Int32 name="count" valueReference="6" causality="parameter" variability="fixed" start="1"/>
    <Clock name="tick" valueReference="7" causality="input" intervalVariability="triggered"/>
  </ModelVariables>
  <ModelStructure><Output valueReference="3"/></ModelStructure>
</fmiModelDescription>
"""

FOR_MODEL_EXCHANGE = (
    DESCRIPTION.replace("fmiVersion", 'numberOfEventIndicators="0" fmiVersion')
    .replace('canHandleVariableCommunicationStepSize="true"', "")
    .replace("CoSimulation", "ModelExchange")
    .replace(
        "  </ModelVariables>",
        '<ScalarVariable name="der" valueReference="4"><Real derivative="4"/></ScalarVariable>'
        "</ModelVariables>",
    )
    .replace("</Outputs>", '</Outputs><Derivatives><Unknown index="7"/></Derivatives>')
)

EXPERIMENT = '<DefaultExperiment startTime="0" stopTime="4" stepSize="0.01"/>'

SOURCE = r"""
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct { Logger logger; void *other[4]; } Callbacks;
typedef struct { double value[5]; const Callbacks *callbacks; } Body;
enum { RATE, T0, FAULT, T, STEPS };
enum { OK = 0, ERROR = 3, FATAL = 4 };
static double all_steps;  /* of a library that is not loaded anew */

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                      const Callbacks *callbacks, int visible, int logging) {
    Body *body = calloc(1, sizeof *body);
    body->callbacks = callbacks;
    body->value[RATE] = 0.5;
    body->value[T0] = 400;
    return body;
}
void fmi2FreeInstance(void *body) { free(body); }
int fmi2SetupExperiment(void *b, int d, double t, double start, int s, double stop) { return OK; }
int fmi2EnterInitializationMode(void *b) { return OK; }
int fmi2ExitInitializationMode(void *b) {
    Body *body = b;
    body->value[T] = body->value[T0];
    return OK;
}
int fmi2SetReal(void *b, const unsigned *which, size_t n, const double *value) {
    for (size_t i = 0; i < n; i++) ((Body *)b)->value[which[i]] = value[i];
    return OK;
}
int fmi2GetReal(void *b, const unsigned *which, size_t n, double *value) {
    for (size_t i = 0; i < n; i++) value[i] = ((Body *)b)->value[which[i]];
    return OK;
}
int fmi2DoStep(void *b, double time, double step, int no_set) {
    Body *body = b;
    double *v = body->value;
    int fault = (int)v[FAULT];
    if (fault == 1 || fault == 2) {
        FILE *file = fopen("trace.txt", "w");
        fputs("written in the folder of the row", file);
        fclose(file);
        body->callbacks->logger(NULL, "body", ERROR, "error", "no heat is left");
        return fault == 1 ? ERROR : FATAL;
    }
    if (fault == 3) v[T] = NAN;
    if (fault == 4) abort();
    if (fault == 5) sleep(300);
    v[T] = 300 + (v[T] - 300) * exp(-v[RATE] * step);
    v[STEPS] = ++all_steps;
    return OK;
}
int fmi2GetContinuousStates(void *b, double *x, size_t n) {
    x[0] = ((Body *)b)->value[T];
    return OK;
}
int fmi2SetContinuousStates(void *b, const double *x, size_t n) {
    ((Body *)b)->value[T] = x[0];
    return OK;
}
int fmi2GetDerivatives(void *b, double *dx, size_t n) {
    double *v = ((Body *)b)->value;
    dx[0] = -v[RATE] * (v[T] - 300);
    return OK;
}
int fmi2GetNominalsOfContinuousStates(void *b, double *x, size_t n) {
    x[0] = 1;
    return OK;
}
int fmi2NewDiscreteStates(void *b, int *info) {
    for (int i = 0; i < 5; i++) info[i] = 0;
    return OK;
}
int fmi2CompletedIntegratorStep(void *b, int no_set, int *enter, int *terminate) {
    *enter = *terminate = 0;
    return OK;
}
#define STUB(name) int fmi2##name(void) { return OK; }
STUB(SetDebugLogging) STUB(Terminate) STUB(Reset) STUB(GetInteger) STUB(GetBoolean)
STUB(GetString) STUB(SetInteger) STUB(SetBoolean) STUB(SetString) STUB(GetFMUstate)
STUB(SetFMUstate) STUB(FreeFMUstate) STUB(SerializedFMUstateSize) STUB(SerializeFMUstate)
STUB(DeSerializeFMUstate) STUB(GetDirectionalDerivative) STUB(SetRealInputDerivatives)
STUB(GetRealOutputDerivatives) STUB(CancelStep) STUB(GetStatus) STUB(GetRealStatus)
STUB(EnterEventMode) STUB(EnterContinuousTimeMode) STUB(SetTime) STUB(GetEventIndicators)
STUB(GetIntegerStatus) STUB(GetBooleanStatus) STUB(GetStringStatus)
"""

FUNCTIONS_3 = r"""
typedef void (*Logger3)(void *, int, const char *, const char *);
static Logger3 log_3;
static void log_2(void *e, const char *n, int status, const char *kind, const char *text, ...) {
    log_3(NULL, status, kind, text);
}
static const Callbacks callbacks_3 = {log_2};
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
        char visible, char logging, char events, char early, const unsigned *required, size_t n,
        void *environment, Logger3 logger, void *update) {
    log_3 = logger;
    return fmi2Instantiate(name, 1, token, resources, &callbacks_3, visible, logging);
}
void fmi3FreeInstance(void *body) { fmi2FreeInstance(body); }
int fmi3EnterInitializationMode(void *b, char d, double t, double start, char s, double stop) {
    return OK;
}
int fmi3ExitInitializationMode(void *b) { return fmi2ExitInitializationMode(b); }
int fmi3Terminate(void *b) { return OK; }
int fmi3SetFloat64(void *b, const unsigned *which, size_t n, const double *value, size_t m) {
    return fmi2SetReal(b, which, n, value);
}
int fmi3GetFloat64(void *b, const unsigned *which, size_t n, double *value, size_t m) {
    return fmi2GetReal(b, which, n, value);
}
int fmi3SetFloat32(void *b, const unsigned *which, size_t n, const float *value, size_t m) {
    for (size_t i = 0; i < n; i++) ((Body *)b)->value[which[i]] = value[i];
    return OK;
}
int fmi3GetFloat32(void *b, const unsigned *which, size_t n, float *value, size_t m) {
    for (size_t i = 0; i < n; i++) value[i] = ((Body *)b)->value[which[i]];
    return OK;
}
int fmi3DoStep(void *b, double time, double step, char no_set, char *event, char *terminate,
        char *early, double *last) {
    *event = *terminate = *early = 0;
    *last = time + step;
    return fmi2DoStep(b, time, step, no_set);
}
"""


def write(path, library, description=DESCRIPTION, experiment=EXPERIMENT, platform=""):
    """Write an FMU: the compiled library with a description."""
    import fmpy

    with zipfile.ZipFile(path, "w") as file:
        file.writestr("modelDescription.xml", description.format(experiment=experiment))
        here = fmpy.platform if 'fmiVersion="2' in description else fmpy.platform_tuple
        place = platform or here
        file.write(library, f"binaries/{place}/cooling{fmpy.sharedLibraryExtension}")
        file.writestr("resources/readme.txt", "nothing")


def stubs_3():
    """Return the other functions of FMI 3, which FMPy demands though no row calls them."""
    from fmpy.fmi3 import _FMU3

    names = {name for name in dir(_FMU3) if name.startswith("fmi3")}
    return "".join(
        f"int {name}(void) {{ return OK; }}\n"
        for name in sorted(names)
        if f"{name}(" not in FUNCTIONS_3
    )


def compiled(folder, source=SOURCE):
    """Return the library of the FMU; skip a test where it cannot be made."""
    pytest.importorskip("fmpy")
    if not shutil.which("gcc"):
        pytest.skip("gcc is not installed: no FMU can be made")
    (folder / "cooling.c").write_text(source + FUNCTIONS_3 + stubs_3())
    library = folder / "cooling.library"
    command = ["gcc", "-shared", "-fPIC", "-O1", "-w", "cooling.c", "-lm", "-o", library]
    subprocess.run(command, cwd=folder, check=True)
    return library
