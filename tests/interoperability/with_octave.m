% Opens a result file with Octave's load and ncread. Octave sees the dimensions reversed, so that
% its columns are our rows.
pkg load netcdf
arguments = argv ();
path = arguments{1};
loaded = load (path);
lines = strsplit (fileread (arguments{2}), "\n");
for k = 1:numel (lines)
  if isempty (lines{k})
    continue
  end
  parts = strsplit (lines{k}, "\t", "CollapseDelimiters", false);
  name = parts{1};
  shape = sscanf (parts{3}, "%d")';
  values = sscanf (parts{5}, "%f");
  found = {loaded.(name), ncread(path, name)};
  readers = {"load", "ncread"};
  for j = 1:2
    if ! isequaln (double (found{j}(:)), values)
      error ("%s: %s gives other values than were written", name, readers{j})
    end
    if numel (shape) == 2 && all (shape > 0) && ! isequal (size (found{j}), fliplr (shape))
      error ("%s: %s gives shape %s", name, readers{j}, mat2str (size (found{j})))
    end
  end
  if ! strcmp (ncreadatt (path, name, "units"), parts{4})
    error ("%s: units are %s", name, ncreadatt (path, name, "units"))
  end
end
if ! strcmp (ncreadatt (path, "/", "case_toml"), fileread (arguments{3}))
  error ("case_toml is not the text as written")
end
if ! strcmp (ncreadatt (path, "body", "flag_meanings"), "crank coupler follower")
  error ("the names of the bodies are lost")
end
