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


def write(path, library, description=DESCRIPTION, experiment=EXPERIMENT, platform=""):
    """Write an FMU: the compiled library with a description."""
    import fmpy

    with zipfile.ZipFile(path, "w") as file:
        file.writestr("modelDescription.xml", description.format(experiment=experiment))
        place = platform or fmpy.platform
        file.write(library, f"binaries/{place}/cooling{fmpy.sharedLibraryExtension}")
        file.writestr("resources/readme.txt", "nothing")


def compiled(folder, source=SOURCE):
    """Return the library of the FMU; skip a test where it cannot be made."""
    pytest.importorskip("fmpy")
    if not shutil.which("gcc"):
        pytest.skip("gcc is not installed: no FMU can be made")
    (folder / "cooling.c").write_text(source)
    library = folder / "cooling.library"
    command = ["gcc", "-shared", "-fPIC", "-O1", "-w", "cooling.c", "-lm", "-o", library]
    subprocess.run(command, cwd=folder, check=True)
    return library
