function clearance_vector (path, joint, picture)
% Draws the clearance vector of a joint: clearance_vector ('RESULT.h5', 'A', 'PICTURE.png')
  run = load_run (path);
  k = find (strcmp (run.names.clearance, joint));
  drawing = figure ('visible', 'off');
  plot (run.clearance_x(:, k) * 1e3, run.clearance_y(:, k) * 1e3);
  axis ('equal');
  xlabel ('x (mm)');
  ylabel ('y (mm)');
  title (['Journal centre in joint ' joint]);
  print (drawing, picture);
  fprintf ('%s: largest eccentricity %.17g m\n', joint, max (run.eccentricity(:, k)));
end
