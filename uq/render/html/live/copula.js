// How inputs with rank correlations depend on each other: a Gaussian copula, as
// uq/assess/densities.py. `excess` is the inverse of the matrix of correlations, less the unit matrix;
// its determinant is the same under all laws.

function logCopula(correlated, integrated, laws, columns) {
  const {names, excess} = correlated.find(one => one.without === (integrated ?? null));
  const z = names.map(name => laws.get(name).normal(columns.get(name).values));
  return z.length ? z[0].map((_, row) => {
    let sum = 0;
    z.forEach((one, i) => z.forEach((other, j) => { sum += one[row] * excess[i][j] * other[row]; }));
    return -sum / 2;
  }) : null;
}
