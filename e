/dev/fd/3: line 79: ../fp3: No such file or directory
