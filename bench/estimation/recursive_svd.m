% The recursive SVD as published, in GNU Octave: thin SVD of [sqrt(lambda) S; d V] for every row, V <- V V'; beside it
% the SVD of the 3000 rows of the last 30 s. Times to set beside bench/estimation/recursive_bench.cpp.
1;
function t = update_time(m, count)
  lambda = 0.9997; V = eye(m); S = zeros(m, 1); D = randn(count, m);
  tic;
  for k = 1:count
    [U, s, W] = svd([diag(sqrt(lambda) * S); D(k, :) * V], "econ");
    S = diag(s); V = V * W;
  endfor
  t = toc / count;
endfunction
rand("seed", 1); randn("seed", 1);
for n = 4:8
  D = randn(3000, n + 1);
  tic; for k = 1:50, [U, s, V] = svd(D, "econ"); endfor, full = toc / 50;
  printf("octave %s: n_p %d: update %.2f us, svd of 3000 rows %.0f us\n", version(), n, 1e6 * update_time(n + 1, 5000), 1e6 * full);
endfor
